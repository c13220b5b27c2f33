#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "graspd/eval/pose_accuracy.hpp"
#include "graspd/formats/table.hpp"
#include "graspd/parts/catalogue.hpp"
#include "graspd/simulation/scene.hpp"

/// What `./run bench accuracy` prints and writes.
namespace graspd::bench {

inline constexpr double kDegree_rad = M_PI / 180;

struct Measured {
  eval::PoseAccuracy accuracy;
  std::vector<double> times_ms;  ///< one for each frame; none where a frame is not this part's own
};

/// One row for each part, and one for all.
Table accuracy_table();
std::vector<std::string> row_of(const std::string& name, const Measured& measured);

struct Frame {
  int k = 0;
  const simulation::SceneOptions& scene;
};

/// A row for each answer and each missed object.
Table record_table();
void add_records(const eval::PoseAccuracy& accuracy, const Frame& frame,
                 const parts::Catalogue& catalogue, Table& records);

/// `NAME.recall` and the like.
void add_figures(const std::string& name, const Measured& measured, nlohmann::json& figures);
/// The figures that targets are about: of the worst part, and of all answers. After `add_figures`
/// of each part and of "all".
void add_targets(const std::vector<const parts::Part*>& parts, nlohmann::json& figures);

/// Of frames in which a part is looked for that is not there.
/// \param scores of each frame's answers.
Table absent_table();
std::vector<std::string> absent_row(const std::string& name,
                                    const std::vector<std::vector<double>>& scores);
void add_absent_figures(const std::string& name, const std::vector<std::vector<double>>& scores,
                        nlohmann::json& figures);

/// What accuracy_plots.py draws of a part.
nlohmann::json plot_of(const parts::Part& part, const eval::PoseAccuracy& accuracy);

}  // namespace graspd::bench
