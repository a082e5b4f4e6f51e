#include <brdfs/measured/bsdf_xml/selection.h>

#include <fmt/format.h>
#include <Eigen/Dense>

#include <algorithm>
#include <set>

namespace hshfit::brdfs {
namespace {

bool isReflection(const BsdfBlock& block, BsdfSide side) {
    return sameWord(block.direction,
                    side == BsdfSide::front ? "Reflection Front" : "Reflection Back");
}

std::string list(const std::set<std::string>& words) {
    return words.empty() ? "none" : fmt::format("{}", fmt::join(words, ", "));
}

const BsdfBlock* findBlock(const BsdfDocument& document, BsdfSide side,
                           std::string_view wavelength) {
    const BsdfBlock* found = nullptr;
    for (const BsdfBlock& block : document.blocks()) {
        if (!isReflection(block, side) || !sameWord(block.wavelength, wavelength)) continue;
        if (found) {
            throw document.error(block.offset, fmt::format("a second block {}, {}; expected one",
                                                           block.direction, block.wavelength));
        }
        found = &block;
    }
    return found;
}

InputError absent(const BsdfDocument& document, BsdfSide side, std::string_view wavelength) {
    std::set<std::string> here;
    for (const BsdfBlock& block : document.blocks()) {
        here.insert(block.direction + " " + block.wavelength);
    }
    return InputError(fmt::format(
        "{}: no block Reflection {} for {} light; it has: {} (options: side, wavelength)",
        document.where(), side == BsdfSide::front ? "Front" : "Back", wavelength, list(here)));
}

void addFacts(BsdfSelection& selection, const BsdfDocument& document) {
    constexpr std::string_view structures[] = {"columns", "rows", "tensor tree of rank 3",
                                               "tensor tree of rank 4"};
    std::set<std::string> unused;
    std::int64_t transmission = 0;
    for (const BsdfBlock& block : document.blocks()) {
        const bool used = &block == selection.main || &block == selection.colour[0] ||
                          &block == selection.colour[1];
        if (used) continue;
        const bool through =
            block.direction.size() >= 12 &&
            sameWord(std::string_view(block.direction).substr(0, 12), "Transmission");
        transmission += through ? 1 : 0;
        if (!through) unused.insert(block.direction + " " + block.wavelength);
    }
    selection.facts = {
        {"format", "bsdf-xml"},
        {"structure", std::string(structures[static_cast<int>(document.structure())])},
        {"side", selection.side == BsdfSide::front ? "front" : "back"},
        {"wavelength", selection.wavelength},
        {"ignored_transmission_blocks", transmission},
        {"other_reflection_blocks", list(unused)},
        {"layers", static_cast<std::int64_t>(document.layers())},
    };
    if (!document.material().empty()) selection.facts.emplace_back("material", document.material());
    if (!document.manufacturer().empty())
        selection.facts.emplace_back("manufacturer", document.manufacturer());
}

/// Columns: the primaries, scaled so that together they are (1, 1, 1).
Eigen::Matrix3d rgbToXyz() {
    Eigen::Matrix3d primaries;
    constexpr double xy[3][2] = {{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}};  // ITU-R BT.709
    for (int i = 0; i < 3; ++i) {
        primaries.col(i) << xy[i][0], xy[i][1], 1 - xy[i][0] - xy[i][1];
    }
    const Eigen::Vector3d scale = primaries.colPivHouseholderQr().solve(Eigen::Vector3d::Ones());
    return primaries * scale.asDiagonal();
}

}  // namespace

BsdfSelection selectBlocks(const BsdfDocument& document, BsdfSide side,
                           std::string_view wavelength) {
    BsdfSelection selection;
    selection.side = side;
    selection.main = findBlock(document, side, wavelength);
    if (!selection.main) throw absent(document, side, wavelength);
    selection.wavelength = selection.main->wavelength;
    selection.name = document.where();
    const bool visible = sameWord(wavelength, "visible");
    std::string options = side == BsdfSide::back ? "side=back" : "";
    if (!visible) {
        options += fmt::format("{}wavelength={}", options.empty() ? "" : ",", wavelength);
    }
    if (!options.empty()) selection.name += ":" + options;
    if (visible) {
        const bool tree = document.isTree();
        selection.colour = {findBlock(document, side, tree ? "CIE-u" : "CIE-X"),
                            findBlock(document, side, tree ? "CIE-v" : "CIE-Z")};
        if (!selection.colour[0] || !selection.colour[1]) selection.colour = {};
    }
    addFacts(selection, document);
    return selection;
}

std::array<double, 3> rgbOfXyz(double x, double y, double z) {
    static const Eigen::Matrix3d matrix = rgbToXyz().inverse();
    const Eigen::Vector3d rgb = matrix * Eigen::Vector3d(x, y, z);
    return {rgb[0], rgb[1], rgb[2]};
}

// x = 9 u' / (6 u' - 16 v' + 12), y = 4 v' / (the same): X = Y 9 u' / 4 v', and
// Z = Y (12 - 3 u' - 20 v') / 4 v'. Without light files have v' = 0.
std::array<double, 3> rgbOfYuv(double y, double u, double v) {
    if (!(v >= 1e-3)) return {y, y, y};
    u = std::clamp(u, 0.0, 1.0);
    v = std::min(v, 1.0);
    return rgbOfXyz(y * 9 * u / (4 * v), y, y * (12 - 3 * u - 20 * v) / (4 * v));
}

}  // namespace hshfit::brdfs
