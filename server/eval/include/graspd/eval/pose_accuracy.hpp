#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "graspd/eval/pose_error.hpp"
#include "graspd/formats/bop.hpp"
#include "graspd/parts/catalogue.hpp"
#include "graspd/types/enum_names.hpp"

/// How well posed parts agree with the true poses. An answer is right where its MSSD to a true
/// object that no better answer has taken is below a tenth of the diameter. Objects visible by less
/// than half neither help nor hurt (Brégier 2017). One record for each answer and each object;
/// every figure is computed from the records of however many images.
namespace graspd::eval {

/// On one answer; `kIgnored` hits an object that is visible by less than half.
enum class Verdict { kRight, kWrong, kIgnored };

/// One answer against the truth.
struct PosedAnswer {
  int im_id = 0;
  int obj_id = 0;
  double score = 0;
  Verdict verdict = Verdict::kWrong;
  double visible_fraction = 0;  ///< of the object that it hit; 0 where wrong
  PoseError error;              ///< to the object that it hit
};

/// An object visible by half or more.
struct TrueObject {
  int im_id = 0;
  int obj_id = 0;
  double visible_fraction = 0;
  bool is_found = false;
};

struct Spread {
  double median = 0;
  double p90 = 0;
};

/// Precision and recall of the answers with at least this score.
struct CurvePoint {
  double threshold = 0;
  double precision = 0;
  double recall = 0;
};

struct VisibilityBin;

/// The records of any number of images.
struct PoseAccuracy {
  std::vector<PosedAnswer> answers;
  std::vector<TrueObject> objects;

  PoseAccuracy& operator+=(const PoseAccuracy& other);
  /// The records of one part.
  PoseAccuracy of_part(int obj_id) const;

  int objects_n() const { return static_cast<int>(objects.size()); }
  int found_n() const;
  int answers_n() const;  ///< without the ignored ones
  int right_n() const;
  /// found_n / objects_n; 0 of none.
  double recall() const;
  /// right_n / answers_n; 0 of none.
  double precision() const;

  /// One point for each distinct score, the highest first.
  std::vector<CurvePoint> curve() const;
  /// Area under the curve, each step of recall at the precision it was reached with (no
  /// interpolation): what is never found costs its whole share.
  double average_precision() const;

  /// Of the right answers; nothing where there is none.
  std::optional<Spread> translation_error_m() const;
  /// Likewise, after the part's symmetries.
  std::optional<Spread> rotation_error_rad() const;

  /// From 0.5 in steps of 0.1, the last one closed. A wrong answer hits no object, so that it is in
  /// no bin: precision is of the whole alone.
  std::vector<VisibilityBin> by_visibility() const;
};

/// The objects that are visible by `from` to `to`.
struct VisibilityBin {
  double from = 0;
  double to = 0;
  PoseAccuracy accuracy;
};

/// \param results of this image; the best score chooses first.
PoseAccuracy pose_accuracy(std::span<const BopResult> results, const BopImage& image,
                           const parts::Catalogue& catalogue);

}  // namespace graspd::eval

template <>
struct graspd::EnumNames<graspd::eval::Verdict> {
  static constexpr std::string_view what = "verdict";
  static constexpr std::pair<eval::Verdict, std::string_view> values[] = {
      {eval::Verdict::kRight, "right"},
      {eval::Verdict::kWrong, "wrong"},
      {eval::Verdict::kIgnored, "ignored"}};
};
