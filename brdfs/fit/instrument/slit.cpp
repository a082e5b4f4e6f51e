#include <brdfs/fit/instrument/slit.h>

#include <hshfit/error.h>
#include <hshfit/linear_algebra/decompositions.h>
#include <hshfit/quadrature/quadrature.h>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace hshfit::brdfs {
namespace {

using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Distance from the middle at which the slit ends, nm.
double reachOf(const Slit& slit) {
    if (slit.shape == Slit::Shape::box) return slit.width / 2;
    return slit.shape == Slit::Shape::triangle ? slit.width : 3 * slit.width;
}

double responseAt(const Slit& slit, double distance) {
    const double d = std::abs(distance) / slit.width;
    if (slit.shape == Slit::Shape::box) return 1;
    if (slit.shape == Slit::Shape::triangle) return 1 - d;
    return std::exp(-4 * std::log(2.0) * d * d);
}

/// Ends of pieces on which response and f are smooth, from the middle.
std::vector<double> piecesOf(const Slit& slit, double middle, const std::vector<double>& knots) {
    const double reach = reachOf(slit);
    std::vector<double> ends{-reach, 0, reach};
    for (double at = -reach; at < reach; at += slit.width / 2) ends.push_back(at);
    for (const double knot : knots)
        if (std::abs(knot - middle) < reach) ends.push_back(knot - middle);
    std::ranges::sort(ends);
    return ends;
}

/// Adds a share of f at a wavelength, linear between knots.
void addShare(double wavelength, double share, const std::vector<double>& knots, double* row) {
    const auto above = std::ranges::upper_bound(knots, wavelength);
    const auto next = static_cast<std::size_t>(above - knots.begin());
    if (next == 0 || next == knots.size()) {
        row[next == 0 ? 0 : next - 1] += share;
        return;
    }
    const double part = (wavelength - knots[next - 1]) / (knots[next] - knots[next - 1]);
    row[next - 1] += share * (1 - part);
    row[next] += share * part;
}

}  // namespace

Slit parseSlit(std::string_view text) {
    Slit result;
    result.text = text;
    if (text.empty()) return result;
    const std::size_t colon = std::min(text.find(':'), text.size());
    const std::string_view shape = text.substr(0, colon),
                           width = text.substr(std::min(colon + 1, text.size()));
    if (shape == "box") result.shape = Slit::Shape::box;
    if (shape == "triangle") result.shape = Slit::Shape::triangle;
    if (shape == "gauss") result.shape = Slit::Shape::gauss;
    const auto parsed = std::from_chars(width.data(), width.data() + width.size(), result.width);
    if (!result.finite() || parsed.ec != std::errc() || parsed.ptr != width.data() + width.size() ||
        !(result.width > 0) || !std::isfinite(result.width))
        throw UsageError(fmt::format(
            "'{}' is no bandwidth; valid: box:NM, triangle:NM or gauss:NM, the full width at half "
            "maximum above 0",
            text));
    return result;
}

std::vector<double> slitMatrix(const Slit& slit, const Channels& channels) {
    const std::size_t count = channels.count();
    std::vector<double> matrix(count * count, 0);
    if (!slit.finite()) {
        for (std::size_t c = 0; c < count; ++c) matrix[c * count + c] = 1;
        return matrix;
    }
    if (channels.kind != Channels::Kind::spectral)
        throw UsageError(
            "a bandwidth is for data with wavelengths; of grey and RGB data the dependence on "
            "wavelength is not known");
    const std::vector<double>& knots = channels.wavelengths;
    if (count < 2)
        throw UsageError(
            "a bandwidth needs at least two wavelengths: one alone does not say how f depends on "
            "them");
    constexpr int points = 8;  // exact for the linear parts; 1e-12 for the Gaussian's pieces
    const GaussRule& rule = gaussLegendre(points);
    for (std::size_t c = 0; c < count; ++c) {
        double* row = matrix.data() + c * count;
        const std::vector<double> ends = piecesOf(slit, knots[c], knots);
        double sum = 0;
        for (std::size_t p = 1; p < ends.size(); ++p)
            for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
                const double half = (ends[p] - ends[p - 1]) / 2;
                const double at = ends[p - 1] + half * (1 + rule.nodes[i]);
                const double share = half * rule.weights[i] * responseAt(slit, at);
                sum += share;
                addShare(knots[c] + at, share, knots, row);
            }
        for (std::size_t k = 0; k < count; ++k) row[k] /= sum;
    }
    constexpr double least = 0.1;
    const auto n = static_cast<Eigen::Index>(count);
    const Eigen::Map<const Square> readings(matrix.data(), n, n);
    const Eigen::MatrixXd squares = readings.transpose() * readings;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(squares);
    const double smallest = std::sqrt(std::max(eigen.eigenvalues()(0), 0.0));
    if (smallest < least)
        throw NumericError(fmt::format(
            "a bandwidth of {} nm at {} wavelengths from {} to {} nm does not determine f at each "
            "of "
            "them: the least singular value of the readings is {:.2g}, expected at least {}",
            slit.width, count, knots.front(), knots.back(), smallest, least));
    return matrix;
}

}  // namespace hshfit::brdfs
