#pragma once

#include "lib/formula_brdf.h"

#include <hshfit/brdf/vectors.h>

#include <cmath>
#include <vector>

namespace hshfit::test {

/// A mirror that is blurred by w radians: f = exp(-|wi - m|^2 / (2 w^2)) / (2 pi w^2 m.z), with m
/// the mirror direction of wo. The integral with the cosine is 1 + O(w^2) while m is well above the
/// horizon.
class BlurredMirror : public FormulaBrdf {
public:
    explicit BlurredMirror(double w)
        : FormulaBrdf([w](const Direction& wi, const Direction& wo) {
              const Direction gap = wi - mirrored(wo);
              return std::exp(-dot(gap, gap) / (2 * w * w)) / (2 * pi * w * w * wo.z);
          }),
          w_(w) {}
    std::vector<Lobe> lobes(const Direction& wo) const override {
        return {{.width = 2.5 * w_, .axis = mirrored(wo)}};
    }

private:
    double w_;
};

}  // namespace hshfit::test
