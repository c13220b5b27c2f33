#pragma once

#include <vector>

namespace graspd::simulation {

/// Samples of a Gaussian at −radius … radius, their sum 1. A sigma of 0 gives the single weight 1.
std::vector<float> gaussian_kernel(double sigma_px);

/// Convolution of an image with a kernel along rows, then columns; nothing comes from beyond the
/// border.
std::vector<float> convolve(const std::vector<float>& image, int width_px, int height_px,
                            const std::vector<float>& kernel);

}  // namespace graspd::simulation
