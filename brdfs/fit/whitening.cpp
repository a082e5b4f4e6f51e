#include <brdfs/fit/whitening.h>

#include <brdfs/fit/dense.h>
#include <hshfit/brdf/vectors.h>
#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>
#include <hshfit/linear_algebra/decompositions.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {
namespace {

/// Degrees and nm: to the resolution of instruments.
constexpr double sameNode = 0.01;

std::optional<std::size_t> nodeOf(const CorrelationBlock& block, double value) {
    const auto above = std::ranges::lower_bound(block.nodes, value - sameNode);
    if (above == block.nodes.end() || *above > value + sameNode) return {};
    return static_cast<std::size_t>(above - block.nodes.begin());
}

/// Degrees from the normal, negative on the side of the light.
double scatteringAngle(const FitSamples& samples, std::size_t k) {
    const Direction& wo = samples.wo[k];
    const double polar = degrees(std::acos(std::clamp(wo.z, -1.0, 1.0)));
    constexpr double steep = 1e-4;  // normal incidence, whose plane is the xz plane
    const bool normal = std::hypot(samples.wiX[k], samples.wiY[k]) < steep;
    const double towards = normal ? wo.x : wo.x * samples.wiX[k] + wo.y * samples.wiY[k];
    return towards > 0 ? -polar : polar;
}

/// The row of a sample in the block over the samples of its scan.
std::size_t placeOf(const CorrelationBlocks& blocks, const FitSamples& samples, std::size_t k) {
    return blocks.angle.size > 0 ? *nodeOf(blocks.angle, scatteringAngle(samples, k))
                                 : samples.scanPlaces[k];
}

std::string nameOf(const FitSamples& samples, std::size_t k) {
    return samples.rows.empty() ? fmt::format("sample {}", k + 1)
                                : fmt::format("line {}", samples.rows[k]);
}

[[noreturn]] void failNode(const CorrelationBlocks& blocks, const char* block, double value,
                           const char* unit, const std::string& of) {
    throw InputError(fmt::format("{}: {}: has no node for {:.6g} {}{}; expected one for each",
                                 blocks.path, block, value, unit, of));
}

}  // namespace

Cholesky::Cholesky(const Matrix& matrix) {
    constexpr double least = 1e-10;
    const Eigen::LLT<Matrix> factor(matrix);
    lower = factor.matrixL();
    if (factor.info() == Eigen::Success && lower.diagonal().minCoeff() > std::sqrt(least)) return;
    lower.setZero();
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
        for (Eigen::Index j = 0; j < i; ++j)
            lower(i, j) =
                (matrix(i, j) - lower.row(i).head(j).dot(lower.row(j).head(j))) / lower(j, j);
        const double rest = matrix(i, i) - lower.row(i).head(i).squaredNorm();
        if (!(rest > least)) {
            failed = static_cast<std::size_t>(i);
            return;
        }
        lower(i, i) = std::sqrt(rest);
    }
}

Matrix correlationOfChannels(const FitSamples& samples) {
    const std::size_t count = samples.channels.count();
    Matrix result = Matrix::Identity(at(count), at(count));
    const SigmaCorrelation& own = samples.correlation;
    if (!own.ofWavelengths()) return result;
    const std::vector<double>& nanometres = samples.channels.wavelengths;
    for (std::size_t c = 0; c < count; ++c)
        for (std::size_t d = 0; d < count; ++d) {
            double& value = result(at(c), at(d));
            if (own.wavelength > 0) {
                value = std::exp(-std::abs(nanometres[c] - nanometres[d]) / own.wavelength);
                continue;
            }
            const CorrelationBlock& block = own.blocks->wavelength;
            value = block.matrix[*nodeOf(block, nanometres[c]) * block.size +
                                 *nodeOf(block, nanometres[d])];
        }
    return result;
}

double correlationOfSamples(const FitSamples& samples, std::size_t j, std::size_t k) {
    const SigmaCorrelation& own = samples.correlation;
    if (own.angle > 0) {
        const double apart = angleBetween(samples.wo[j], samples.wo[k]);
        return std::exp(-apart / own.angle);
    }
    const CorrelationBlock& block =
        own.blocks->angle.size > 0 ? own.blocks->angle : own.blocks->scan;
    return block
        .matrix[placeOf(*own.blocks, samples, j) * block.size + placeOf(*own.blocks, samples, k)];
}

std::vector<std::vector<std::size_t>> correlatedBlocks(const FitSamples& samples) {
    std::vector<std::vector<std::size_t>> blocks;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const std::size_t block = samples.correlation.ofAngles() ? samples.scans[k] : k;
        if (block >= blocks.size()) blocks.resize(block + 1);
        blocks[block].push_back(k);
    }
    return blocks;
}

void checkCorrelations(const FitSamples& samples) {
    if (!samples.correlation.blocks) return;
    const CorrelationBlocks& blocks = *samples.correlation.blocks;
    if (blocks.wavelength.size > 0)
        for (const double nm : samples.channels.wavelengths)
            if (!nodeOf(blocks.wavelength, nm)) failNode(blocks, "wavelength", nm, "nm", "");
    if (blocks.angle.size > 0)
        for (std::size_t k = 0; k < samples.size(); ++k)
            if (const double angle = scatteringAngle(samples, k); !nodeOf(blocks.angle, angle))
                failNode(blocks, "angle", angle, "degrees",
                         fmt::format(" ({} of the data)", nameOf(samples, k)));
    if (blocks.scan.size == 0) return;
    const auto scans = correlatedBlocks(samples);
    for (std::size_t s = 0; s < scans.size(); ++s)
        if (scans[s].size() != blocks.scan.size)
            throw InputError(
                fmt::format("{}: scan: has {} rows, but scan {} has {} samples that are fitted; "
                            "expected a row for each",
                            blocks.path, blocks.scan.size, s + 1, scans[s].size()));
}

Whitening::Whitening(const FitSamples& samples)
    : samples_(samples.size()), channels_(samples.channels.count()) {
    if (samples.correlation.ofWavelengths()) {
        const Cholesky factor(correlationOfChannels(samples));
        if (factor.failed)
            throw UsageError(fmt::format(
                "errors at {} nm are those at shorter wavelengths, by the stated correlation; "
                "state a smaller one",
                samples.channels.wavelengths[*factor.failed]));
        ofChannels_ = factor.lower;
    }
    if (!samples.correlation.ofAngles()) return;
    blocks_ = correlatedBlocks(samples);
    std::size_t numbers = 0;
    for (const auto& block : blocks_) numbers += block.size() * block.size();
    if (numbers > most)
        throw UsageError(fmt::format(
            "the stated correlation has {} numbers, of pairs of samples of a scan; a fit takes {}, "
            "such as a scan of 10,000 samples or 100 of 1,000: take fewer samples, or leave out "
            "the correlation",
            numbers, most));
    ofBlocks_.resize(blocks_.size());
    eachInParallel(blocks_.size(), [&](std::size_t b) {
        const std::vector<std::size_t>& block = blocks_[b];
        Matrix matrix = Matrix::Identity(at(block.size()), at(block.size()));
        for (std::size_t j = 0; j < block.size(); ++j)
            for (std::size_t k = 0; k < j; ++k)
                matrix(at(j), at(k)) = matrix(at(k), at(j)) =
                    correlationOfSamples(samples, block[j], block[k]);
        Cholesky factor(matrix);
        if (factor.failed)
            throw UsageError(fmt::format(
                "scan {}: the error of {} is known from those before it, by the stated "
                "correlation (1 for two samples of one direction); leave one of them out, or "
                "the correlation",
                b + 1, nameOf(samples, block[*factor.failed])));
        ofBlocks_[b] = std::move(factor.lower);
    });
}

void Whitening::apply(Eigen::Ref<Matrix> rows) const {
    const auto columns = static_cast<std::size_t>(rows.cols());
    if (ofChannels_.size() > 0)
        eachInParallel(columns, [&](std::size_t i) {
            Matrix own = rows.col(at(i)).reshaped(at(samples_), at(channels_)).transpose();
            ofChannels_.triangularView<Eigen::Lower>().solveInPlace(own);
            rows.col(at(i)) = own.transpose().reshaped();
        });
    eachInParallel(ofBlocks_.size(), [&](std::size_t b) {
        const std::vector<std::size_t>& block = blocks_[b];
        Matrix own(at(block.size()), at(channels_ * columns));
        const auto each = [&](const auto& work) {
            for (std::size_t i = 0; i < columns; ++i)
                for (std::size_t c = 0; c < channels_; ++c)
                    for (std::size_t k = 0; k < block.size(); ++k)
                        work(rows(at(c * samples_ + block[k]), at(i)),
                             own(at(k), at(i * channels_ + c)));
        };
        each([](double& value, double& copy) { copy = value; });
        ofBlocks_[b].triangularView<Eigen::Lower>().solveInPlace(own);
        each([](double& value, double& copy) { value = copy; });
    });
}

}  // namespace hshfit::brdfs
