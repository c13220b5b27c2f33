#pragma once

#include <btBulletDynamicsCommon.h>

namespace graspd::sim_cell {

/// The rack and pinion of a parallel gripper: both jaws are always as far from the palm's origin.
/// One row of Jacobian: what one jaw gains along the palm's x, the other loses.
class JawCoupling final : public btTypedConstraint {
 public:
  JawCoupling(btRigidBody& jaw, btRigidBody& other_jaw, const btRigidBody& palm)
      : btTypedConstraint(MAX_CONSTRAINT_TYPE, jaw, other_jaw), palm_(palm) {}

  void getInfo1(btConstraintInfo1* info) override;
  void getInfo2(btConstraintInfo2* info) override;
  void setParam(int, btScalar, int) override {}
  btScalar getParam(int, int) const override { return 0; }

 private:
  const btRigidBody& palm_;
};

}  // namespace graspd::sim_cell
