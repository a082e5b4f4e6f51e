#include <brdfs/measured/bsdf_xml/data_cursor.h>
#include <brdfs/measured/bsdf_xml/klems_brdf.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {
namespace {

/// The bases that a name may stand for: the file's own, or those known by that name.
std::vector<AngleBasis> basesNamed(const BsdfDocument& document, const BsdfBlock& block,
                                   const std::string& name) {
    for (const AngleBasis& basis : document.bases())
        if (sameWord(basis.name, name)) return {basis};
    std::vector<AngleBasis> known = standardAngleBases(name);
    if (known.empty()) {
        throw document.error(block.offset,
                             fmt::format("angle basis '{}' is neither defined in the file nor one "
                                         "of LBNL/Klems Full, Half and Quarter",
                                         name));
    }
    return known;
}

}  // namespace

KlemsBrdf::KlemsBrdf(const BsdfDocument& document, BsdfSelection selection)
    : selection_(std::move(selection)) {
    laws_.nonNegative = true;
    values_ = readMatrix(document, *selection_.main);
    if (!selection_.spectrum.empty()) readSpectrum(document);
    if (selection_.coloured()) {
        std::vector<std::vector<double>> xyz;
        xyz.push_back(readMatrix(document, *selection_.colour[0]));
        xyz.push_back(std::move(values_));
        xyz.push_back(readMatrix(document, *selection_.colour[1]));
        combineColours(std::move(xyz));
    }
    selection_.forgetBlocks();
    findLaws();
}

/// The matrices of further wavelengths, after the first's.
void KlemsBrdf::readSpectrum(const BsdfDocument& document) {
    std::vector<double> nanometres;
    for (const BsdfBlock* block : selection_.spectrum) {
        nanometres.push_back(block->nanometres);
        if (block == selection_.main) continue;
        const std::vector<double> matrix = readMatrix(document, *block);
        values_.insert(values_.end(), matrix.begin(), matrix.end());
    }
    channels_ = Channels::spectral(std::move(nanometres));
}

/// One matrix as [outgoing][incident], with a census of its values and 0 in place of invalid ones.
std::vector<double> KlemsBrdf::readMatrix(const BsdfDocument& document, const BsdfBlock& block) {
    std::vector<double> read;
    DataCursor cursor(document, block);
    for (double value = 0; cursor.take(value);) read.push_back(value);
    if (cursor.next() != 0) {
        throw cursor.error(fmt::format("{} among the numbers of a matrix", cursor.found()));
    }
    const std::vector<AngleBasis> columns = basesNamed(document, block, block.columnBasis);
    const std::vector<AngleBasis> rows = basesNamed(document, block, block.rowBasis);
    bool fits = false;
    for (const AngleBasis& column : columns) {
        for (const AngleBasis& row : rows) {
            if (fits || column.patches() * row.patches() != read.size()) continue;
            fits = true;
            incident_ = column;
            outgoing_ = row;
        }
    }
    const std::size_t ni = columns[0].patches(), no = rows[0].patches();
    if (!fits) {
        throw document.error(
            block.offset,
            fmt::format("{} values for {} x {} patches of '{}' and '{}', expected "
                        "{}",
                        read.size(), ni, no, block.columnBasis, block.rowBasis, ni * no));
    }
    if (missing_.empty()) missing_.resize(read.size());
    if (missing_.size() != read.size()) {
        throw document.error(block.offset, "another angle basis than that of the first matrix");
    }
    const bool transposed = document.structure() == BsdfDocument::Structure::rows;
    const std::size_t incidents = incident_.patches(), outgoings = outgoing_.patches();
    std::vector<double> matrix(read.size());
    for (std::size_t o = 0; o < outgoings; ++o) {
        for (std::size_t i = 0; i < incidents; ++i) {
            const double value = read[transposed ? i * outgoings + o : o * incidents + i];
            const std::size_t to = o * incidents + i;
            census_.add(value);
            if (!std::isfinite(value)) missing_[to] = 1;
            matrix[to] = std::isfinite(value) ? asReflectance(value) : 0;
        }
    }
    census_.values += read.size();
    if (cursor.corruptOffset() != 0 && selection_.corrupt.empty()) {
        selection_.corrupt =
            cursor.errorAt(cursor.corruptOffset(), "a value is NaN or infinite, expected a number")
                .what();
    }
    return matrix;
}

void KlemsBrdf::combineColours(std::vector<std::vector<double>> xyz) {
    channels_ = Channels::rgb();
    const std::size_t cells = xyz[1].size();
    values_.resize(3 * cells);
    for (std::size_t k = 0; k < cells; ++k) {
        const std::array<double, 3> rgb = rgbOfXyz(xyz[0][k], xyz[1][k], xyz[2][k]);
        for (std::size_t c = 0; c < 3; ++c) values_[c * cells + k] = asReflectance(rgb[c]);
    }
}

std::size_t KlemsBrdf::incidentPatch(const Direction& wi) const {
    return incident_.patchOf(-selection_.fileX(wi.x), -wi.y, wi.z);
}
std::size_t KlemsBrdf::outgoingPatch(const Direction& wo) const {
    return outgoing_.patchOf(selection_.fileX(wo.x), wo.y, wo.z);
}

void KlemsBrdf::eval(const Direction& wo, DirectionBatch wi, double* out) const {
    const std::size_t count = channels_.count();
    const std::size_t o = wo.z > 0 ? outgoingPatch(wo) : AngleBasis::none;
    if (o == AngleBasis::none) {
        std::fill_n(out, count * wi.count, 0.0);
        return;
    }
    for (std::size_t k = 0; k < wi.count; ++k) {
        const bool above = wi.z[k] > 0;
        const std::size_t i = above ? incidentPatch({wi.x[k], wi.y[k], wi.z[k]}) : AngleBasis::none;
        for (std::size_t c = 0; c < count; ++c) {
            out[c * wi.count + k] = i == AngleBasis::none ? 0 : value(c, i, o);
        }
    }
}

void KlemsBrdf::coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const {
    const std::size_t o = wo.z > 0 ? outgoingPatch(wo) : AngleBasis::none;
    for (std::size_t k = 0; k < wi.count; ++k) {
        const std::size_t i = o != AngleBasis::none && wi.z[k] > 0
                                  ? incidentPatch({wi.x[k], wi.y[k], wi.z[k]})
                                  : AngleBasis::none;
        covered[k] = i != AngleBasis::none && missing_[o * incident_.patches() + i] == 0;
    }
}

std::vector<double> KlemsBrdf::kinks(const Direction&) const {
    return incident_.boundaryCosines();
}

std::vector<double> KlemsBrdf::outgoingKinks(const Direction&) const {
    return outgoing_.boundaryCosines();
}

std::vector<KinkCurve> KlemsBrdf::kinkCurves(const Direction&) const {
    return meridians(incident_);
}

std::vector<KinkCurve> KlemsBrdf::outgoingKinkCurves(const Direction&) const {
    return meridians(outgoing_);
}

// A plane through the pole is the same for (x, y) and (-x, -y).
std::vector<KinkCurve> KlemsBrdf::meridians(const AngleBasis& basis) const {
    std::vector<double> heights = basis.boundaryCosines();
    heights.insert(heights.begin(), 1);
    heights.push_back(0);
    std::vector<KinkCurve> curves;
    for (std::size_t r = 0; r < basis.rings().size(); ++r) {
        const std::size_t n = basis.rings()[r].azimuths;
        if (n == 1) continue;
        // A plane through the pole crosses the ring at two opposite azimuths.
        for (std::size_t j = 0; j < (n % 2 == 0 ? n / 2 : n); ++j) {
            const double phi = 2 * pi * (static_cast<double>(j) + 0.5) / static_cast<double>(n);
            curves.push_back({.x = -std::sin(phi),
                              .y = selection_.fileX(std::cos(phi)),
                              .low = heights[r + 1],
                              .high = heights[r]});
        }
    }
    return curves;
}

Direction KlemsBrdf::cellCentre(std::size_t cell) const {
    const AngleBasis::Ring& ring = incident_.rings()[incident_.ringOf(cell)];
    const double theta = ring.azimuths == 1 ? ring.lower : (ring.lower + ring.upper) / 2;
    const Direction from =
        directionFromAngles(radians(theta), 2 * pi * static_cast<double>(cell - ring.first) /
                                                static_cast<double>(ring.azimuths));
    return {-selection_.fileX(from.x), -from.y, from.z};
}

double KlemsBrdf::directionalReflectance(std::size_t channel, std::size_t incident) const {
    double sum = 0;
    for (std::size_t ring = 0; ring < outgoing_.rings().size(); ++ring) {
        const AngleBasis::Ring& patches = outgoing_.rings()[ring];
        for (std::size_t j = 0; j < patches.azimuths; ++j) {
            sum +=
                value(channel, incident, patches.first + j) * outgoing_.projectedSolidAngle(ring);
        }
    }
    return sum;
}

}  // namespace hshfit::brdfs
