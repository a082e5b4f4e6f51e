#include <brdfs/measured/bsdf_xml/selection.h>
#include <brdfs/measured/text_reader.h>

#include <fmt/format.h>
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

namespace hshfit::brdfs {
namespace {

struct Kind {
    BsdfSide side;
    std::string_view block, word;
};

/// In the order in which they are looked for.
constexpr Kind kinds[] = {
    {BsdfSide::front, "Reflection Front", "front"},
    {BsdfSide::back, "Reflection Back", "back"},
    {BsdfSide::transmissionFront, "Transmission Front", "transmission-front"},
    {BsdfSide::transmissionBack, "Transmission Back", "transmission-back"},
};

const Kind& kindOf(BsdfSide side) {
    return *std::ranges::find(kinds, side, &Kind::side);
}

bool isOf(const BsdfBlock& block, BsdfSide side) {
    return sameWord(block.direction, blockName(side));
}

std::string list(const std::set<std::string>& words) {
    return words.empty() ? "none" : fmt::format("{}", fmt::join(words, ", "));
}

const BsdfBlock* findBlock(const BsdfDocument& document, BsdfSide side,
                           std::string_view wavelength) {
    const BsdfBlock* found = nullptr;
    for (const BsdfBlock& block : document.blocks()) {
        if (!isOf(block, side) || !sameWord(block.wavelength, wavelength)) continue;
        if (found) {
            throw document.error(block.offset, fmt::format("a second block {}, {}; expected one",
                                                           block.direction, block.wavelength));
        }
        found = &block;
    }
    return found;
}

InputError absent(const BsdfDocument& document, std::optional<BsdfSide> side,
                  std::string_view wavelength) {
    std::set<std::string> here;
    for (const BsdfBlock& block : document.blocks())
        here.insert(block.direction + " " + block.wavelength);
    return InputError(fmt::format(
        "{}: no block {} for {}; it has: {} (options: side, wavelength)", document.where(),
        side ? blockName(*side) : "of reflection or transmission",
        wavelength.empty() ? "visible light or single wavelengths" : wavelength, list(here)));
}

/// The wavelength that an option states, in nm; none for a word.
std::optional<double> nanometresIn(std::string_view wavelength) {
    double nm = 0;
    if (!takeNumber(wavelength, nm) || (!wavelength.empty() && !sameWord(wavelength, "nm")))
        return std::nullopt;
    return nm;
}

/// All blocks of single wavelengths, or of the one that is asked for, ascending.
std::vector<const BsdfBlock*> findSpectrum(const BsdfDocument& document, BsdfSide side,
                                           std::optional<double> nanometres) {
    std::vector<const BsdfBlock*> found;
    for (const BsdfBlock& block : document.blocks())
        if (block.nanometres > 0 && isOf(block, side) &&
            (!nanometres || std::fabs(block.nanometres - *nanometres) < 1e-6))
            found.push_back(&block);
    std::ranges::stable_sort(found, {}, &BsdfBlock::nanometres);
    for (std::size_t k = 1; k < found.size(); ++k)
        if (found[k]->nanometres == found[k - 1]->nanometres)
            throw document.error(found[k]->offset,
                                 fmt::format("a second block {}, {}; expected one",
                                             found[k]->direction, found[k]->wavelength));
    return found;
}

/// Fills in the blocks for one side; false if the file has none.
bool takeSide(BsdfSelection& selection, const BsdfDocument& document, BsdfSide side,
              std::string_view wavelength) {
    selection.side = side;
    const std::optional<double> nanometres = nanometresIn(wavelength);
    const bool bySpectrum = nanometres || sameWord(wavelength, "spectrum");
    if (!bySpectrum)
        selection.main = findBlock(document, side, wavelength.empty() ? "visible" : wavelength);
    if (bySpectrum || (!selection.main && wavelength.empty())) {
        selection.spectrum = findSpectrum(document, side, nanometres);
        if (!selection.spectrum.empty()) selection.main = selection.spectrum.front();
    }
    return selection.main != nullptr;
}

std::string optionsOf(const BsdfSelection& selection, std::string_view wavelength) {
    std::string options =
        selection.side == BsdfSide::front ? "" : fmt::format("side={}", sideWord(selection.side));
    if (!wavelength.empty() && !sameWord(wavelength, "visible"))
        options += fmt::format("{}wavelength={}", options.empty() ? "" : ",", wavelength);
    return options;
}

void addFacts(BsdfSelection& selection, const BsdfDocument& document) {
    constexpr std::string_view structures[] = {"columns", "rows", "tensor tree of rank 3",
                                               "tensor tree of rank 4"};
    std::set<std::string> reflections, transmissions;
    for (const BsdfBlock& block : document.blocks()) {
        const bool used = &block == selection.main || &block == selection.colour[0] ||
                          &block == selection.colour[1] ||
                          std::ranges::find(selection.spectrum, &block) != selection.spectrum.end();
        if (used) continue;
        const bool through =
            block.direction.size() >= 12 &&
            sameWord(std::string_view(block.direction).substr(0, 12), "Transmission");
        (through ? transmissions : reflections).insert(block.direction + " " + block.wavelength);
    }
    selection.facts = {
        {"format", "bsdf-xml"},
        {"structure", std::string(structures[static_cast<int>(document.structure())])},
        {"side", std::string(sideWord(selection.side))},
        {"wavelength", selection.wavelength},
        {"other_reflection_blocks", list(reflections)},
        {"other_transmission_blocks", list(transmissions)},
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

std::string_view blockName(BsdfSide side) {
    return kindOf(side).block;
}

std::string_view sideWord(BsdfSide side) {
    return kindOf(side).word;
}

std::optional<BsdfSide> sideNamed(std::string_view word) {
    if (constexpr std::string_view prefix = "reflection-"; word.starts_with(prefix))
        word.remove_prefix(prefix.size());
    const auto* found = std::ranges::find(kinds, word, &Kind::word);
    return found == std::end(kinds) ? std::nullopt : std::optional(found->side);
}

BsdfSide counterpart(BsdfSide side) {
    switch (side) {
        case BsdfSide::front:
            return BsdfSide::transmissionFront;
        case BsdfSide::back:
            return BsdfSide::transmissionBack;
        case BsdfSide::transmissionFront:
            return BsdfSide::front;
        case BsdfSide::transmissionBack:
            break;
    }
    return BsdfSide::back;
}

bool hasBlocks(const BsdfDocument& document, BsdfSide side, std::string_view wavelength) {
    BsdfSelection selection;
    return takeSide(selection, document, side, wavelength);
}

BsdfSelection selectBlocks(const BsdfDocument& document, std::optional<BsdfSide> side,
                           std::string_view wavelength) {
    BsdfSelection selection;
    const bool reflects = std::ranges::any_of(document.blocks(), [](const BsdfBlock& block) {
        return isOf(block, BsdfSide::front) || isOf(block, BsdfSide::back);
    });
    const bool any = std::ranges::any_of(kinds, [&](const Kind& kind) {
        const bool wanted = side ? *side == kind.side : !(reflects && isTransmission(kind.side));
        return wanted && takeSide(selection, document, kind.side, wavelength);
    });
    if (!any) throw absent(document, side, wavelength);
    const bool spectral = !selection.spectrum.empty();
    selection.wavelength = !spectral ? selection.main->wavelength
                           : selection.spectrum.size() == 1
                               ? selection.main->wavelength
                               : fmt::format("{} wavelengths", selection.spectrum.size());
    selection.name = document.where();
    if (const std::string options = optionsOf(selection, wavelength); !options.empty())
        selection.name += ":" + options;
    if (!spectral && sameWord(selection.main->wavelength, "visible")) {
        const bool tree = document.isTree();
        selection.colour = {findBlock(document, selection.side, tree ? "CIE-u" : "CIE-X"),
                            findBlock(document, selection.side, tree ? "CIE-v" : "CIE-Z")};
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
