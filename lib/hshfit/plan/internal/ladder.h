#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/representation/forms/form.h>
#include <hshfit/scene/scene.h>

#include <span>
#include <string>
#include <vector>

namespace hshfit::plan {

using scene::Limits;
using scene::Material;
using scene::Scene;

/// A candidate form of a material, before it has been tried.
struct Rung {
    Form form;
    std::size_t source = 0;  ///< which of the material's versions (all channels, one channel)
    /// Expected size of the numbers. Factors of low rank take less.
    std::size_t bytes = 0;
};

/// One version of a material and the parts that may be split off first.
struct LadderSource {
    const Brdf* brdf = nullptr;
    /// Specifications for Form::split, "" for none, and the numbers that each adds to a file.
    std::vector<std::pair<std::string, std::size_t>> splits = {{"", 0}};
};

/// The forms that a plan tries.
struct LadderOptions {
    std::vector<std::string> bases = {"hsh", "zernike", "makhotkin"};
    int maxOrder = 12;
    std::size_t maxBytes = 0;
    ViewRange views;
};

/// Every form worth trying, from few bytes to many, in an order that depends on nothing else.
///     outgoing   f and f cos(theta_i); elevations, a parabolic map or the one direction there is;
///                every order; ranks 2 to 16 from order 5 on
///     basis      every order: the symmetric half of f where reciprocal, else f and f cos(theta_i)
///     halfway    five sizes, of what is symmetric only where reciprocal
/// each in float32, half, unorm16 and unorm8.
std::vector<Rung> ladder(std::span<const LadderSource> sources, const LadderOptions& options);

/// The halfway forms alone, of the first split of a material's first version.
std::vector<Rung> halfwayRungs(const LadderSource& source, const LadderOptions& options);

/// The form without its precision: forms that share one projection.
bool sameNumbers(const Form& a, const Form& b);

}  // namespace hshfit::plan
