#include "perception_runs.hpp"

#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <ctime>

#include "graspd/command_line/progress.hpp"
#include "graspd/eval/evaluate.hpp"
#include "graspd/perception/planner.hpp"
#include "graspd/perception/preprocess.hpp"
#include "graspd/simulation/scene.hpp"
#include "peers/peers.hpp"
#include "piles.hpp"

namespace graspd::bench {
namespace {

constexpr std::array kCameraHeights_m{0.7, 0.8, 0.9};  // frame by frame in turn
/// Two parts can't have their barycentres nearer than this share of the diameter.
constexpr double kSamePlaceShare = 0.25;

constexpr std::pair<const char*, perception::SegmentationMethod> kSegmentationPeers[] = {
    {"pcl_octree_dbscan", pcl_octree_dbscan},
    {"pcl_kdtree_dbscan", pcl_kdtree_dbscan},
    {"open3d_dbscan", open3d_dbscan}};

constexpr std::pair<const char*, PoseFinder (*)(const parts::Part&)> kPosePeers[] = {
    {"pcl_pca_icp", pcl_pca_icp},       {"pcl_sac_ia_icp", pcl_sac_ia_icp},
    {"pcl_ndt_icp", pcl_ndt_icp},       {"pcl_ppf_icp", pcl_ppf_icp},
    {"opencv_ppf_icp", opencv_ppf_icp}, {"open3d_fpfh_icp", open3d_fpfh_icp}};

/// What `work` returns, and what it took of the processor.
template <class Work>
auto timed(double& time_ms, Work work) {
  const std::clock_t start = std::clock();
  auto result = work();
  time_ms = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  return result;
}

/// The frames of one part, from each of the heights.
class Frames {
 public:
  static Result<Frames> create(const parts::Catalogue& catalogue, const parts::Part& part,
                               const PerceptionOptions& options) {
    Frames frames;
    for (const double height_m : kCameraHeights_m) {
      simulation::SceneOptions scene = pile_of(part, options.parts_per_frame_n, height_m);
      scene.seed = options.seed;
      auto maker = simulation::SceneMaker::create(catalogue, scene);
      if (!maker) return tl::unexpected(maker.error());
      frames.makers_.push_back(*std::move(maker));
    }
    return frames;
  }
  static double height_m(int k) { return kCameraHeights_m[k % kCameraHeights_m.size()]; }
  Result<BopImage> make(int k) const { return makers_[k % makers_.size()].make(k); }

 private:
  std::vector<simulation::SceneMaker> makers_;
};

/// Best score first, without those in a place that a better one has.
std::vector<ScoredPose> best_per_place(std::vector<ScoredPose> poses, const parts::Part& part) {
  std::stable_sort(poses.begin(), poses.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
  std::vector<ScoredPose> kept;
  for (const ScoredPose& pose : poses) {
    const Eigen::Vector3d place_m = pose.T_camera_part * part.barycentre_m;
    const bool is_taken = std::any_of(kept.begin(), kept.end(), [&](const ScoredPose& better) {
      return (better.T_camera_part * part.barycentre_m - place_m).norm() <
             kSamePlaceShare * part.diameter_m;
    });
    // What a library answers where it has failed may be no number.
    if (!is_taken && place_m.allFinite()) kept.push_back(pose);
  }
  return kept;
}

/// Everything that is measured on one part's frames.
class PartBench {
 public:
  PartBench(const parts::Catalogue& catalogue, const parts::Part& part)
      : catalogue_(catalogue), part_(part) {
    for (const auto& [name, prepare] : kPosePeers) peers_.emplace_back(name, prepare(part));
  }

  /// \param with_peers their pipelines and the paper's too, which take seconds.
  Result<void> measure(const BopImage& image, double camera_height_m, bool with_peers,
                       std::vector<Run>& runs) const {
    const PlanRequest request = eval::request_for(image, catalogue_, {part_.id});
    Run blank;
    blank.part_id = part_.id;
    blank.frame = image.im_id;
    blank.camera_height_m = camera_height_m;
    const perception::Parameters parameters;
    const perception::Cloud cloud =
        perception::prepare_scene(image.frame, request, part_.diameter_m, parameters).cloud;
    segment(image, cloud, blank, runs);

    perception::Parameters paper = parameters;
    paper.segmentation.method = Segmentation::kImprovedDbscan;
    paper.registration.method = Registration::kPcaIcp;
    if (auto ok = plan(image, request, kGraspd, parameters, 1, blank, runs); !ok) return ok;
    if (auto ok = plan(image, request, kGraspd2, parameters, 2, blank, runs); !ok) return ok;
    if (!with_peers) return {};
    find(image, cloud, blank, runs);
    return plan(image, request, kPaper, paper, 1, blank, runs);
  }

 private:
  Result<void> plan(const BopImage& image, const PlanRequest& request, const char* name,
                    const perception::Parameters& parameters, std::size_t cores_n, Run run,
                    std::vector<Run>& runs) const {
    const tbb::global_control cores(tbb::global_control::max_allowed_parallelism, cores_n);
    const auto report = eval::evaluate_image(image, 0, request, catalogue_, parameters);
    if (!report) return tl::unexpected(report.error());
    run.method = name;
    run.time_ms = 1e3 * (cores_n == 1 ? report->cpu_time_s : report->time_s);
    add(*report->poses, run, runs);
    return {};
  }

  void segment(const BopImage& image, const perception::Cloud& cloud, Run run,
               std::vector<Run>& runs) const {
    const tbb::global_control one_core(tbb::global_control::max_allowed_parallelism, 1);
    run.task = kSegmentation;
    const auto run_one = [&](std::string_view name, perception::SegmentationMethod method) {
      const auto segments = timed(run.time_ms, [&] { return method(cloud, dbscan_parameters()); });
      const auto accuracy = eval::segmentation_accuracy(cloud, segments, image);
      run.method = name;
      run.objects_n = accuracy.objects_n;
      run.found_n = accuracy.found_n;
      runs.push_back(run);
    };
    for (const auto& [method, name] : EnumNames<Segmentation>::values) {
      run_one(name, perception::segmentation_method(method));
    }
    for (const auto& [name, method] : kSegmentationPeers) {
      run_one(name, method);
    }
  }

  void find(const BopImage& image, const perception::Cloud& cloud, Run run,
            std::vector<Run>& runs) const {
    const tbb::global_control one_core(tbb::global_control::max_allowed_parallelism, 1);
    for (const auto& [name, finder] : peers_) {
      const auto poses =
          timed(run.time_ms, [&, &find = finder] { return best_per_place(find(cloud), part_); });
      std::vector<BopResult> results;
      for (const ScoredPose& pose : poses) {
        results.push_back({0, image.im_id, part_.bop_obj_id, pose.score, pose.T_camera_part, 0});
      }
      run.method = name;
      add(eval::pose_accuracy(results, image, catalogue_), run, runs);
    }
  }

  static void add(const eval::PoseAccuracy& accuracy, Run run, std::vector<Run>& runs) {
    run.task = kPoses;
    run.objects_n = accuracy.objects_n();
    run.found_n = accuracy.found_n();
    run.poses = accuracy;
    runs.push_back(std::move(run));
  }

  const parts::Catalogue& catalogue_;
  const parts::Part& part_;
  std::vector<std::pair<std::string, PoseFinder>> peers_;
};

}  // namespace

Result<std::vector<Run>> measure(const parts::Catalogue& catalogue,
                                 const PerceptionOptions& options) {
  std::vector<Run> runs;
  for (const parts::Part& part : catalogue.parts()) {
    const PartBench bench(catalogue, part);
    const auto frames = Frames::create(catalogue, part, options);
    if (!frames) return tl::unexpected(frames.error());
    Progress progress(part.id, static_cast<std::size_t>(options.frames_n));
    for (int k = 0; k < options.frames_n; ++k) {
      const auto image = frames->make(k);
      if (!image) return tl::unexpected(image.error());
      const bool with_peers = k < options.peer_frames_n;
      if (auto ok = bench.measure(*image, Frames::height_m(k), with_peers, runs); !ok) {
        return tl::unexpected(ok.error());
      }
      progress.step();
    }
  }
  return runs;
}

}  // namespace graspd::bench
