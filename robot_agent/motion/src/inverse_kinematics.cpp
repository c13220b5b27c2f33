#include "graspd/motion/inverse_kinematics.hpp"

#include "anno_ik.hpp"
#include "kdl_ik.hpp"

namespace graspd::motion {

Result<std::unique_ptr<InverseKinematics>> make_inverse_kinematics(IkKind kind,
                                                                   const ArmModel& arm) {
  if (kind == IkKind::kAnno) return make_anno_ik(arm);
  return make_kdl_ik(arm);
}

}  // namespace graspd::motion
