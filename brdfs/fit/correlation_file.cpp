#include <brdfs/fit/correlation_file.h>

#include <brdfs/fit/whitening.h>
#include <brdfs/measured/scattered/text_file.h>
#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {
namespace {

constexpr std::size_t mostNodes = 2000;

/// The correlations of a matrix of covariances. Messages count its rows from 1.
Eigen::MatrixXd correlationsIn(const JsonFields& block, std::size_t count) {
    const std::vector<std::vector<double>> rows = block.table("matrix", count, count);
    const auto n = static_cast<Eigen::Index>(count);
    Eigen::MatrixXd matrix(n, n);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = 0; j < count; ++j) {
            if (!(rows[i][i] > 0))
                block.fail(fmt::format("row {} has {} on the diagonal, expected a variance above 0",
                                       i + 1, rows[i][i]),
                           "matrix");
            constexpr double rounding = 1e-6;
            const double size = std::sqrt(rows[i][i]) * std::sqrt(rows[j][j]);
            if (std::abs(rows[i][j] - rows[j][i]) > rounding * size)
                block.fail(fmt::format("row {} has {} in column {}, and row {} has {} in column "
                                       "{}; expected a symmetric matrix",
                                       i + 1, rows[i][j], j + 1, j + 1, rows[j][i], i + 1),
                           "matrix");
            matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
                i == j ? 1 : (rows[i][j] + rows[j][i]) / 2 / size;
        }
    return matrix;
}

CorrelationBlock blockOf(const JsonFields& root, const char* name, bool nodes) {
    CorrelationBlock result;
    if (!root.has(name)) return result;
    const JsonFields block = root.object(name);
    if (nodes) result.nodes = block.numbers("nodes");
    const std::size_t rows = block.at("matrix").size();
    result.size = nodes ? result.nodes.size() : rows;
    if (result.size == 0 || result.size > mostNodes)
        block.fail(fmt::format("has {} rows, expected 1 to {}", result.size, mostNodes), "matrix");
    for (std::size_t i = 1; i < result.nodes.size(); ++i)
        if (!(result.nodes[i] > result.nodes[i - 1]))
            block.fail(fmt::format("value {} is {} after {}, expected ascending values", i + 1,
                                   result.nodes[i], result.nodes[i - 1]),
                       "nodes");
    const Eigen::MatrixXd matrix = correlationsIn(block, result.size);
    const Cholesky factor(matrix);
    if (factor.failed)
        block.fail(fmt::format("row {} makes it not positive definite: its errors would be known "
                               "from those of the rows before it",
                               *factor.failed + 1),
                   "matrix");
    result.matrix.assign(matrix.data(), matrix.data() + matrix.size());
    return result;
}

}  // namespace

std::shared_ptr<const CorrelationBlocks> readCorrelations(const std::string& path) {
    auto result = std::make_shared<CorrelationBlocks>();
    result->path = path;
    withTextFile(path, [&](std::string_view text, const std::string& where) {
        constexpr int deepest = 5;
        const nlohmann::json json = parseJson(text, where, deepest);
        const JsonFields root(json, "", where);
        if (root.word("format") != "hshfit-covariance")
            root.fail("has to be hshfit-covariance", "format");
        root.integer("version", 1, 1);
        for (const auto& [name, value] : root.json().items())
            if (name != "format" && name != "version" && name != "wavelength" && name != "angle" &&
                name != "scan")
                root.fail("is unknown; known: wavelength, angle, scan", name);
        result->wavelength = blockOf(root, "wavelength", true);
        result->angle = blockOf(root, "angle", true);
        result->scan = blockOf(root, "scan", false);
        if (result->angle.size > 0 && result->scan.size > 0)
            root.fail("and angle both state the correlations along a scan; leave out one", "scan");
        if (result->wavelength.size + result->angle.size + result->scan.size == 0)
            root.fail("has no block; expected wavelength, angle or scan");
    });
    return result;
}

}  // namespace hshfit::brdfs
