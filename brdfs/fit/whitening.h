#pragma once

#include <brdfs/fit/fit_samples.h>

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <vector>

namespace hshfit::brdfs {

/// The lower factor of a correlation matrix.
struct Cholesky {
    Eigen::MatrixXd lower;
    /// The first row that is, to 1e-10 of its variance, a combination of the rows before it.
    std::optional<std::size_t> failed;

    explicit Cholesky(const Eigen::MatrixXd& matrix);
};

/// Correlation of the errors at the wavelengths of the samples; the identity where none is stated.
Eigen::MatrixXd correlationOfChannels(const FitSamples& samples);
/// Correlation of the errors of two samples of a scan at one wavelength.
double correlationOfSamples(const FitSamples& samples, std::size_t j, std::size_t k);
/// Indices of the samples whose errors are correlated with one another.
std::vector<std::vector<std::size_t>> correlatedBlocks(const FitSamples& samples);
/// Throws InputError where the file of the correlations lacks a node that the samples need, or has
/// another number of rows than a scan has samples.
void checkCorrelations(const FitSamples& samples);

/// Makes values with correlated errors, over their uncertainties, into independent ones: C = D R D
/// with the uncertainties in D and R = L L^T, a block for each scan, over its samples and the
/// wavelengths. Least squares of L^-1 D^-1 (f - measured) are generalised ones (Aitken 1935).
class Whitening {
public:
    /// Numbers of the factors of all scans together.
    static constexpr std::size_t most = 100'000'000;

    /// Throws UsageError where errors of a scan determine each other, and for more than `most`.
    explicit Whitening(const FitSamples& samples);

    /// rows := L^-1 rows. [channel * samples + sample] by any number of columns.
    void apply(Eigen::Ref<Eigen::MatrixXd> rows) const;

private:
    std::size_t samples_, channels_;
    Eigen::MatrixXd ofChannels_;  ///< empty: wavelengths are independent
    std::vector<std::vector<std::size_t>> blocks_;
    std::vector<Eigen::MatrixXd> ofBlocks_;  ///< none: samples are independent
};

}  // namespace hshfit::brdfs
