#include <fmt/format.h>

#include <memory>

#include "commands.hpp"
#include "exit_codes.hpp"
#include "graspd/client/client.hpp"
#include "graspd/command_line/choices.hpp"
#include "graspd/command_line/help.hpp"
#include "graspd/formats/depth_image.hpp"
#include "graspd/overlay/overlay.hpp"
#include "plan_report.hpp"
#include "request_arguments.hpp"
#include "server_arguments.hpp"

namespace graspd::program {
namespace {

struct PlanArguments {
  ServerArguments servers;
  RequestArguments request;
  std::string depth;
  std::string cell_name;
  std::string overlay;
  bool json = false;
  bool explain = false;
  bool record = false;
  std::string segmentation;
  std::string registration;
  std::string order;
  std::string p_system;
  std::string strategy;
  std::vector<double> strategy_vector{0, 0, 0};
  std::uint32_t max_grasps_n = 0;
  std::string encoding = std::string(name_of(DepthEncoding::kRaw));
  int budget_ms = 10'000;
};

struct AskedFrame {
  DepthFrame frame;
  PlanRequest request;
};

/// Nothing said leaves the server's default.
template <class E>
E choice(const std::string& name) {
  return parse_enum<E>(name).value_or(E::kServerDefault);
}

Result<AskedFrame> read_question(const PlanArguments& arguments) {
  auto cell_request = read_cell_request(arguments.request);
  if (!cell_request) return tl::unexpected(cell_request.error());
  auto image = read_png16(arguments.depth);
  if (!image) return tl::unexpected(image.error());
  const CameraIntrinsics& camera = cell_request->camera;
  if (image->width_px != camera.width_px || image->height_px != camera.height_px) {
    return invalid("{} has {} × {} pixels, but {} describes a camera of {} × {}", arguments.depth,
                   image->width_px, image->height_px, arguments.request.camera, camera.width_px,
                   camera.height_px);
  }
  AskedFrame asked;
  asked.frame = {camera, cell_request->depth_scale_m, std::move(image->values)};
  PlanRequest& request = asked.request;
  request = std::move(cell_request->request);
  request.options.segmentation = choice<Segmentation>(arguments.segmentation);
  request.options.registration = choice<Registration>(arguments.registration);
  request.options.order = choice<GraspOrder>(arguments.order);
  request.options.p_system = choice<PSystem>(arguments.p_system);
  request.options.strategy = choice<Strategy>(arguments.strategy);
  request.options.strategy_vector_base_m = Eigen::Vector3d(arguments.strategy_vector.data());
  request.options.max_grasps_n = arguments.max_grasps_n;
  request.options.explain_rejected = arguments.explain;
  request.options.outlines = !arguments.overlay.empty();
  request.options.record = arguments.record;
  return asked;
}

Result<int> plan(const PlanArguments& arguments) {
  const auto asked = read_question(arguments);
  if (!asked) return tl::unexpected(asked.error());
  auto options = client_options(arguments.servers);
  if (!options) return tl::unexpected(options.error());
  if (!arguments.cell_name.empty()) options->cell = arguments.cell_name;
  options->encoding = parse_enum<DepthEncoding>(arguments.encoding).value();
  client::Client client(arguments.servers.servers, *std::move(options));

  const auto start = std::chrono::steady_clock::now();
  const auto answer =
      client.plan(asked->frame, asked->request, std::chrono::milliseconds(arguments.budget_ms));
  const auto round_trip = std::chrono::steady_clock::now() - start;
  if (!answer) return tl::unexpected(answer.error());

  print_plan(*answer, arguments.json, round_trip);
  if (!arguments.overlay.empty()) {
    const overlay::RgbImage picture = overlay::draw(asked->frame, asked->request, *answer);
    if (auto ok = overlay::write_png(arguments.overlay, picture); !ok) {
      return tl::unexpected(ok.error());
    }
    if (!arguments.json) fmt::print("overlay   {}\n", arguments.overlay);
  }
  return exit_code(answer->outcome);
}

template <class E>
CLI::Option* add_choice(CLI::App& command, const std::string& flag, std::string& value,
                        const std::string& description) {
  return command.add_option(flag, value, description)->check(one_of<E>())->type_name("NAME");
}

void add_options(CLI::App& command, PlanArguments& arguments) {
  add_server_options(command, arguments.servers);
  command.add_option("--depth", arguments.depth, "depth image, 16 bits, one channel")
      ->type_name("PNG")
      ->required();
  for (CLI::Option* option : add_request_options(command, arguments.request)) option->required();
  command
      .add_option("--cell-name", arguments.cell_name,
                  "whose turn the request counts as; default: the key's cell, else 'grasp'")
      ->type_name("NAME");
  command.add_option("--overlay", arguments.overlay, "draw the plan over the depth image")
      ->type_name("PNG");
  command.add_flag("--json", arguments.json, "print the whole answer as JSON");
  command.add_flag("--record", arguments.record, "have the server's flight recorder keep it");
  command.add_flag("--explain", arguments.explain, "list rejected grasps with their reasons");
  add_choice<Segmentation>(command, "--segmentation", arguments.segmentation,
                           "how points are parted into objects; default: the server's");
  add_choice<Registration>(command, "--registration", arguments.registration,
                           "how poses are found; default: the server's");
  add_choice<GraspOrder>(command, "--order", arguments.order,
                         "whether a high or a low GRS comes first; default: the server's");
  add_choice<PSystem>(command, "--p-system", arguments.p_system,
                      "how GRS tells what the pile needs; default: the server's");
  add_choice<Strategy>(command, "--strategy", arguments.strategy,
                       "which object comes first; default: the server's");
  command
      .add_option("--max-grasps", arguments.max_grasps_n, "at most so many; 0: server's default")
      ->type_name("N");
  add_choice<DepthEncoding>(command, "--encoding", arguments.encoding,
                            "of the depth image on its way")
      ->capture_default_str();
  command.add_option("--budget-ms", arguments.budget_ms, "how long to wait for the answer")
      ->check(CLI::Range(1, 3'600'000))
      ->capture_default_str();
}

}  // namespace

void add_plan_command(CLI::App& app) {
  const auto arguments = std::make_shared<PlanArguments>();
  CLI::App* command = app.add_subcommand("plan", "ask for the grasps of one depth frame");
  add_options(*command, *arguments);
  set_help(*command,
           "Exit codes: 0 planned, 1 a defect of the server, 2 wrong command line, file or "
           "request, 3 try again, 4 answered, but nothing to grasp (the outcome says why).",
           {"grasp plan --depth build/piles/depth/000000.png --camera build/piles/camera.yaml \\\n"
            "    --cell build/piles/cell.yaml --part tee --overlay build/plan.png"});
  command->callback([arguments] { finish(plan(*arguments)); });
}

}  // namespace graspd::program
