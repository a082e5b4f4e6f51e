// Properties of a matrix: laws, reflectances, spacing.

#include <brdfs/measured/bsdf_xml/klems_brdf.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {
namespace {

std::string describe(const AngleBasis& basis) {
    std::vector<std::size_t> azimuths;
    for (const AngleBasis::Ring& ring : basis.rings()) azimuths.push_back(ring.azimuths);
    return fmt::format("{}: {} patches, {} rings of {}", basis.name, basis.patches(),
                       basis.rings().size(), fmt::join(azimuths, ", "));
}

void appendAxes(std::vector<Axis>& axes, const AngleBasis& basis, const char* suffix) {
    const std::vector<AngleBasis::Ring>& rings = basis.rings();
    const auto centre = [&](std::size_t k) {
        return k == 0 && rings[0].azimuths == 1 ? 0 : (rings[k].lower + rings[k].upper) / 2;
    };
    Axis theta{fmt::format("theta_{}", suffix), "degrees", rings.size(), centre(0),
               centre(rings.size() - 1),        0};
    for (std::size_t k = 1; k < rings.size(); ++k) {
        theta.largestGap = std::max(theta.largestGap, centre(k) - centre(k - 1));
    }
    std::size_t most = 1, least = 0;
    for (const AngleBasis::Ring& ring : rings) {
        most = std::max(most, ring.azimuths);
        if (ring.azimuths > 1) least = least ? std::min(least, ring.azimuths) : ring.azimuths;
    }
    const auto step = [](std::size_t n) { return 360.0 / static_cast<double>(n); };
    axes.push_back(theta);
    axes.push_back({fmt::format("phi_{}", suffix), "degrees", most, 0, 360 - step(most),
                    step(least ? least : 1)});
}

}  // namespace

/// Whether every value is unchanged when azimuths move and, if asked for, directions are exchanged.
bool KlemsBrdf::sameUnder(int sign, int turn, bool exchanged) const {
    const std::size_t incidents = incident_.patches(), outgoings = outgoing_.patches();
    for (std::size_t c = 0; c < channels_.count(); ++c) {
        for (std::size_t o = 0; o < outgoings; ++o) {
            const std::size_t movedO = outgoing_.moved(o, sign, turn);
            for (std::size_t i = 0; i < incidents; ++i) {
                const std::size_t movedI = incident_.moved(i, sign, turn);
                const double image =
                    exchanged ? value(c, movedO, movedI) : value(c, movedI, movedO);
                if (value(c, i, o) != image) return false;
            }
        }
    }
    return true;
}

bool KlemsBrdf::dependsOnRingsOnly() const {
    for (std::size_t c = 0; c < channels_.count(); ++c) {
        for (std::size_t o = 0; o < outgoing_.patches(); ++o) {
            const std::size_t firstO = outgoing_.rings()[outgoing_.ringOf(o)].first;
            for (std::size_t i = 0; i < incident_.patches(); ++i) {
                const std::size_t firstI = incident_.rings()[incident_.ringOf(i)].first;
                if (value(c, i, o) != value(c, firstI, firstO)) return false;
            }
        }
    }
    return true;
}

// Reciprocity, f(wi, wo) = f(wo, wi), exchanges wi and wo. Patches contain wo and -wi, so that the
// exchange transposes the matrix and turns both patches by 180 degrees.
void KlemsBrdf::findLaws() {
    laws_.reciprocal = !isTransmission(selection_.side) && movable() && sameUnder(1, 1, true);
    laws_.mirrorSymmetric = incident_.symmetric() && outgoing_.symmetric() &&
                            sameUnder(-1, 0, false) && sameUnder(-1, 1, false);
    laws_.isotropic = dependsOnRingsOnly();
    double most = 0;
    for (std::size_t c = 0; c < channels_.count(); ++c)
        for (std::size_t i = 0; i < incident_.patches(); ++i)
            most = std::max(most, directionalReflectance(c, i));
    laws_.energyConserving = most <= 1 + roundingOfFiles;
}

bool KlemsBrdf::addReflection(const KlemsBrdf& reflection) {
    if (reflection.incident_.patches() != incident_.patches() ||
        reflection.channels_.count() != channels_.count())
        return false;
    double most = 0;
    for (std::size_t c = 0; c < channels_.count(); ++c)
        for (std::size_t i = 0; i < incident_.patches(); ++i)
            most = std::max(most,
                            directionalReflectance(c, i) + reflection.directionalReflectance(c, i));
    withReflection_ = most;
    laws_.energyConserving = laws_.energyConserving && most <= 1 + roundingOfFiles;
    return true;
}

/// Whether both bases have the same patches, and directions may be exchanged patch by patch.
bool KlemsBrdf::movable() const {
    if (!incident_.symmetric() || !outgoing_.symmetric()) return false;
    return std::ranges::equal(incident_.rings(), outgoing_.rings(),
                              [](const AngleBasis::Ring& a, const AngleBasis::Ring& b) {
                                  return a.azimuths == b.azimuths && a.upper == b.upper;
                              });
}

std::vector<Axis> KlemsBrdf::axes() const {
    std::vector<Axis> axes;
    appendAxes(axes, incident_, "i");
    appendAxes(axes, outgoing_, "o");
    return axes;
}

std::vector<Fact> KlemsBrdf::facts() const {
    std::vector<Fact> facts = selection_.facts;
    facts.emplace_back("incident_basis", describe(incident_));
    facts.emplace_back("outgoing_basis", describe(outgoing_));
    facts.emplace_back("negative_values", static_cast<std::int64_t>(census_.negative));
    facts.emplace_back("nan_values", static_cast<std::int64_t>(census_.notANumber));
    facts.emplace_back("infinite_values", static_cast<std::int64_t>(census_.infinite));
    const bool through = isTransmission(selection_.side);
    const char* const share = through ? "transmittance" : "reflectance";
    double largest = 0;
    for (const AngleBasis::Ring& ring : incident_.rings()) {
        double low = HUGE_VAL, high = 0;
        for (std::size_t j = 0; j < ring.azimuths; ++j) {
            for (std::size_t c = 0; c < channels_.count(); ++c) {
                const double reflectance = directionalReflectance(c, ring.first + j);
                low = std::min(low, reflectance);
                high = std::max(high, reflectance);
            }
        }
        largest = std::max(largest, high);
        facts.emplace_back(fmt::format("{}_incident_{:g}_to_{:g}", share, ring.lower, ring.upper),
                           fmt::format("{:.6g} to {:.6g}", low, high));
    }
    facts.emplace_back(fmt::format("largest_directional_{}", share), largest);
    if (withReflection_)
        facts.emplace_back("largest_reflectance_and_transmittance", *withReflection_);
    if (through) return facts;
    const std::vector<std::string> names = channels_.names();
    // Values of patches at opposite azimuths exchange under reciprocity.
    if (laws_.reciprocal || !incident_.symmetric() || incident_.patches() != outgoing_.patches()) {
        return facts;
    }
    double defect = 0, sum = 0;
    for (std::size_t o = 0; o < outgoing_.patches(); ++o) {
        for (std::size_t i = 0; i < incident_.patches(); ++i) {
            const double there = value(0, outgoing_.moved(o, 1, 1), incident_.moved(i, 1, 1));
            defect += std::abs(value(0, i, o) - there);
            sum += value(0, i, o) + there;
        }
    }
    facts.emplace_back("reciprocity_defect", sum > 0 ? 2 * defect / sum : 0.0);
    return facts;
}

}  // namespace hshfit::brdfs
