#include <brdfs/fit/correlated_spread.h>

#include <brdfs/fit/dense.h>
#include <brdfs/fit/whitening.h>

#include <tbb/parallel_for.h>

#include <array>

namespace hshfit::brdfs {
namespace {

/// Sums are made in this many parts whatever the number of threads, so that it does not show.
constexpr std::size_t parts = 8;

}  // namespace

Matrix correlatedSpread(
    const FitSamples& samples, std::size_t n,
    const std::function<void(std::size_t v, Eigen::Ref<Eigen::RowVectorXd> row)>& addRow) {
    const std::size_t channels = samples.channels.count();
    const Matrix ofChannels = correlationOfChannels(samples);
    Matrix result = Matrix::Zero(at(n), at(n));
    for (const std::vector<std::size_t>& block : correlatedBlocks(samples)) {
        // The rows of each sample of the block, and the same mixed among the channels.
        std::vector<Matrix> own, mixed;
        for (const std::size_t k : block) {
            own.emplace_back(Matrix::Zero(at(channels), at(n)));
            for (std::size_t c = 0; c < channels; ++c) {
                Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(at(n));
                addRow(c * samples.size() + k, row);
                own.back().row(at(c)) = row;
            }
            mixed.emplace_back(ofChannels * own.back());
        }
        for (std::size_t j = 0; j < block.size(); ++j)
            result.noalias() += own[j].transpose() * mixed[j];
        std::array<Matrix, parts> later;
        tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
            later[part] = Matrix::Zero(at(n), at(n));
            for (std::size_t j = part; j < block.size(); j += parts) {
                Matrix sum = Matrix::Zero(at(channels), at(n));
                for (std::size_t k = 0; k < j; ++k)
                    sum += correlationOfSamples(samples, block[j], block[k]) * mixed[k];
                later[part].noalias() += own[j].transpose() * sum;
            }
        });
        for (const Matrix& sum : later) result += sum + sum.transpose();
    }
    return result;
}

Matrix correlatedSpread(const FitSamples& samples, const WeightedRows& rows, std::size_t n,
                        std::size_t shapes) {
    return correlatedSpread(samples, n, [&](std::size_t v, Eigen::Ref<Eigen::RowVectorXd> row) {
        for (std::size_t i = 0; i < rows.columns; ++i)
            row(at(rows.place(i, v / rows.samples, shapes))) += rows.slopes[v * rows.columns + i];
    });
}

}  // namespace hshfit::brdfs
