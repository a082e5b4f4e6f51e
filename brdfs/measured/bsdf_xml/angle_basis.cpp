#include <brdfs/measured/bsdf_xml/angle_basis.h>
#include <brdfs/measured/bsdf_xml/document.h>

#include <brdfs/measured/angles.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <utility>

namespace hshfit::brdfs {
namespace {

double squaredSine(double degreesFromPole) {
    const double s = std::sin(radians(degreesFromPole));
    return s * s;
}

AngleBasis makeBasis(std::string_view name,
                     std::initializer_list<std::pair<double, std::size_t>> rings) {
    AngleBasis basis;
    basis.name = name;
    for (const auto& [upper, azimuths] : rings) basis.add(upper, azimuths);
    return basis;
}

}  // namespace

void AngleBasis::add(double upper, std::size_t azimuths) {
    const double lower = rings_.empty() ? 0 : rings_.back().upper;
    rings_.push_back({lower, upper, azimuths, patches_});
    patches_ += azimuths;
    projected_.push_back(pi * (squaredSine(upper) - squaredSine(lower)) /
                         static_cast<double>(azimuths));
    upperCosine_.push_back(upper < 90 ? std::cos(radians(upper)) : 0);
}

std::size_t AngleBasis::ringOf(std::size_t patch) const {
    const auto after =
        std::upper_bound(rings_.begin(), rings_.end(), patch,
                         [](std::size_t sought, const Ring& ring) { return sought < ring.first; });
    return static_cast<std::size_t>(after - rings_.begin()) - 1;
}

std::size_t AngleBasis::patchOf(double x, double y, double z) const {
    std::size_t ring = 0;
    while (z <= upperCosine_[ring])
        if (++ring == rings_.size()) return none;
    const Ring& at = rings_[ring];
    if (at.azimuths == 1) return at.first;
    const auto n = static_cast<double>(at.azimuths);
    const double turns = rayAngle(y, x) / (2 * pi);
    // Patch 0 lies on both sides of azimuth 0.
    const double position = (turns < 0 ? turns + 1 : turns) * n + 0.5;
    const auto j = static_cast<std::size_t>(position);
    return at.first + (j < at.azimuths ? j : 0);
}

std::vector<double> AngleBasis::boundaryCosines() const {
    std::vector<double> cosines = upperCosine_;
    if (!cosines.empty() && cosines.back() == 0) cosines.pop_back();
    return cosines;
}

bool AngleBasis::symmetric() const {
    return std::ranges::all_of(
        rings_, [](const Ring& ring) { return ring.azimuths == 1 || ring.azimuths % 2 == 0; });
}

std::size_t AngleBasis::moved(std::size_t patch, int sign, int turn) const {
    const Ring& ring = rings_[ringOf(patch)];
    const std::size_t n = ring.azimuths, j = patch - ring.first;
    const std::size_t half = turn != 0 ? n / 2 : 0;
    return ring.first + (sign < 0 ? n - j + half : j + half) % n;
}

std::vector<AngleBasis> standardAngleBases(std::string_view name) {
    static const std::vector<AngleBasis> all{
        makeBasis("LBNL/Klems Full", {{5, 1},
                                      {15, 8},
                                      {25, 16},
                                      {35, 20},
                                      {45, 24},
                                      {55, 24},
                                      {65, 24},
                                      {75, 16},
                                      {90, 12}}),
        makeBasis("LBNL/Klems Half",
                  {{6.5, 1}, {19.5, 8}, {32.5, 12}, {45.5, 16}, {58.5, 20}, {71.5, 12}, {90, 8}}),
        makeBasis("LBNL/Klems Half",
                  {{6.5, 1}, {19.5, 8}, {32.5, 12}, {46.5, 16}, {61.5, 20}, {76.5, 12}, {90, 4}}),
        makeBasis("LBNL/Klems Quarter", {{9, 1}, {27, 8}, {45, 12}, {63, 12}, {90, 8}}),
        makeBasis("LBNL/Klems Quarter", {{9, 1}, {27, 8}, {46, 12}, {66, 12}, {90, 8}}),
    };
    std::vector<AngleBasis> found;
    for (const AngleBasis& basis : all)
        if (sameWord(basis.name, name)) found.push_back(basis);
    return found;
}

}  // namespace hshfit::brdfs
