#!/usr/bin/python3
"""A whole client of graspd.v1: asks a server for the grasps of one depth frame.

usage: plan.py tcp://HOST:PORT DEPTH.png CAMERA.yaml CELL.yaml PART [SERVER.pub CELL.key]

Needs Debian's python3-zmq, python3-protobuf, python3-pil and python3-yaml, and the messages' code:
    protoc --python_out=build/python -I proto graspd/v1/plan.proto graspd/v1/envelope.proto
    export PYTHONPATH=build/python
"""
import array, os, sys, zlib
import yaml, zmq
from PIL import Image
from graspd.v1.envelope_pb2 import Answer, FrameDescription, PlanCall, Request
from graspd.v1.plan_pb2 import (Bin, CameraIntrinsics, Distortion, Gripper, PlanAnswer, PlanRequest, Pose,
                                Quaternion, RequestedPart, Vector3)

BUDGET_MS = 10_000

def read(path):  # OpenCV's YAML has a first line and a tag of its own
    return yaml.safe_load(open(path).read().replace("%YAML:1.0", "").replace("!!opencv-matrix", ""))

def words(path):  # of a key file, below its comment
    return [line for line in open(path) if not line.startswith("#")][0].split()

def pose(m):  # a 4 × 4 matrix row by row; of the multiples of the quaternion the longest is the most exact
    (a, b, c), (d, e, f), (g, h, i) = m[0:3], m[4:7], m[8:11]
    multiples = [(1 + a + e + i, h - f, c - g, d - b), (h - f, 1 + a - e - i, b + d, c + g),
                 (c - g, b + d, 1 - a + e - i, f + h), (d - b, c + g, f + h, 1 - a - e + i)]
    w, x, y, z = max(multiples, key=lambda q: sum(v * v for v in q))
    n = (w * w + x * x + y * y + z * z) ** 0.5
    return Pose(translation_m=vector([m[3], m[7], m[11]]), rotation=Quaternion(w=w / n, x=x / n, y=y / n, z=z / n))

def vector(v):
    return Vector3(x=v[0], y=v[1], z=v[2])

def main(endpoint, depth, camera_file, cell_file, part, server_pub=None, cell_key=None):
    camera, cell, image = read(camera_file), read(cell_file), Image.open(depth)
    pixels = array.array("H", image.getdata()).tobytes()  # uint16, as this machine has it: little-endian
    k, lens = camera["camera_matrix"]["data"], camera["distortion_coefficients"]["data"]
    frame = FrameDescription(
        camera=CameraIntrinsics(width_px=image.width, height_px=image.height, fx_px=k[0], fy_px=k[4], cx_px=k[2],
                                cy_px=k[5], distortion=Distortion(**dict(zip(("k1", "k2", "p1", "p2", "k3"), lens)))),
        depth_scale_m=camera["depth_scale_m"], encoding=FrameDescription.RAW,
        payload_bytes=len(pixels), payload_crc32=zlib.crc32(pixels))
    plan = PlanRequest(
        T_base_camera=pose(camera["T_base_camera"]), parts=[RequestedPart(id=part)],
        bin=Bin(T_base_bin=pose(cell["bin"]["T_base_bin"]), inner_size_m=vector(cell["bin"]["inner_size_m"])),
        gripper=Gripper(kind=Gripper.PARALLEL_JAW, max_opening_m=0.08, clearance_m=0.005, standoff_m=0.08, retreat_m=0.1,
                        jaw_size_m=vector([0.008, 0.016, 0.045]), palm_size_m=vector([0.1, 0.06, 0.06])))
    request = Request(protocol_version=1, id=os.urandom(16), attempt=1, cell="python", budget_ms=BUDGET_MS,
                      plan=PlanCall(frame=frame, request=plan))
    socket = zmq.Context.instance().socket(zmq.DEALER)
    socket.linger = 0
    if cell_key:  # NAME PUBLIC_KEY SECRET_KEY; of the server without the last
        request.cell, public_key, secret_key = words(cell_key)
        socket.curve_publickey, socket.curve_secretkey = public_key.encode(), secret_key.encode()
        socket.curve_serverkey = words(server_pub)[1].encode()
    socket.connect(endpoint)
    socket.send_multipart([request.SerializeToString(), pixels])
    answer = Answer()
    while answer.id != request.id:  # the server answers each request once, and not in order
        if not socket.poll(BUDGET_MS):
            sys.exit(f"no answer within {BUDGET_MS} ms: is a server at {endpoint}, and does it know this key?")
        answer.ParseFromString(socket.recv())
    if answer.code != Answer.OK:
        sys.exit(f"{Answer.Code.Name(answer.code)}: {answer.message}")
    print(PlanAnswer.Outcome.Name(answer.plan.outcome), answer.plan.reason)
    for grasp in answer.plan.grasps:
        at = grasp.T_base_grasp.translation_m
        print(f"object {grasp.object_id} at ({at.x:.3f}, {at.y:.3f}, {at.z:.3f}) m, "
              f"jaws open by {grasp.opening_width_m:.3f} m, score {grasp.score:.2f}")

if __name__ == "__main__":
    main(*sys.argv[1:]) if len(sys.argv) in (6, 8) else sys.exit(__doc__)
