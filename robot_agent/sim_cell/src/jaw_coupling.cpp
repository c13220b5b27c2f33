#include "jaw_coupling.hpp"

namespace graspd::sim_cell {

void JawCoupling::getInfo1(btConstraintInfo1* info) {
  info->m_numConstraintRows = 1;
  info->nub = 5;
}

// c = (a + b − 2p) · x = 0 for the jaws' centres a and b, the palm's origin p and its axis x, which
// turns with it. The palm's motion is known, so that it stands on the right-hand side: a' · x + b'
// · x = 2 p' · x − (a + b − 2p) · (ω × x) − erp · c / dt.
void JawCoupling::getInfo2(btConstraintInfo2* info) {
  const btVector3 x = palm_.getWorldTransform().getBasis().getColumn(0);
  const btVector3 sum = m_rbA.getCenterOfMassPosition() + m_rbB.getCenterOfMassPosition() -
                        btScalar(2) * palm_.getCenterOfMassPosition();
  for (int i = 0; i < 3; ++i) {
    info->m_J1linearAxis[i] = x[i];
    info->m_J2linearAxis[i] = x[i];
  }
  info->m_constraintError[0] = btScalar(2) * palm_.getLinearVelocity().dot(x) -
                               sum.dot(palm_.getAngularVelocity().cross(x)) -
                               info->erp * info->fps * sum.dot(x);
}

}  // namespace graspd::sim_cell
