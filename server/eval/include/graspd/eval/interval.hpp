#pragma once

namespace graspd::eval {

/// Of a share, both ends in [0, 1].
struct Interval {
  double low = 0;
  double high = 1;
};

/// Where the true share lies with 95 % confidence, after Wilson 1927. Of no trials, anywhere.
Interval wilson(int hits_n, int all_n);

}  // namespace graspd::eval
