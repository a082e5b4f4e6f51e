#include <brdfs/measured/scattered/sides.h>

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace hshfit::brdfs {
namespace {

constexpr double below = -1.1e-3;  // cosines from here on belong to the front

Direction turnedToBack(const Direction& d) {
    return {-d.x, d.y, -d.z};
}

}  // namespace

Parameter sideParameter(std::string_view help) {
    return {.name = "side",
            .help = help,
            .kind = Parameter::Kind::choice,
            .choices = {"auto", "reflection-front", "reflection-back", "transmission-front",
                        "transmission-back"}};
}

SidedSamples::SidedSamples(const Channels& channels) {
    for (Samples& samples : sides_) samples.channels = channels;
}

Samples* SidedSamples::add(const Direction& in, const Direction& out, std::span<const double> f,
                           const Row& row) {
    const bool back = !(in.z > below);
    const Direction wi = back ? turnedToBack(in) : in;
    Direction wo = back ? turnedToBack(out) : out;
    const bool through = !(wo.z > below);
    if (through) wo.z = -wo.z;
    Samples& samples = sides_[(through ? 2U : 0U) + (back ? 1U : 0U)];
    const std::size_t before = samples.size();
    samples.add(wi, wo, f, row);
    return samples.size() > before ? &samples : nullptr;
}

Samples SidedSamples::take(std::string_view side, const std::string& where) {
    std::vector<std::string> here;
    for (std::size_t k = 0; k < sides_.size(); ++k)
        if (sides_[k].size() > 0)
            here.push_back(fmt::format("{} ({} samples)", sideWords[k], sides_[k].size()));
    std::size_t chosen = sides_.size();
    for (std::size_t k = 0; k < sides_.size() && chosen == sides_.size(); ++k)
        if (sides_[k].size() > 0 && (side == "auto" || side == sideWords[k])) chosen = k;
    if (chosen == sides_.size())
        throw InputError(
            fmt::format("{}: no samples{}; it has: {}", where,
                        side == "auto" ? "" : fmt::format(" of side={}", side),
                        here.empty() ? "none" : fmt::format("{}", fmt::join(here, ", "))));
    Samples samples = std::move(sides_[chosen]);
    samples.side = sideWords[chosen];
    std::erase_if(here, [&](const std::string& text) { return text.starts_with(samples.side); });
    for (std::string& text : here) samples.leftOut.push_back(std::move(text) + ", option side");
    return samples;
}

}  // namespace hshfit::brdfs
