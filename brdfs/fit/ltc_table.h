#pragma once

#include <brdfs/fit/ltc_lobe.h>

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// The map from the roughness r of the table, 0 to 1, to the value of a parameter.
enum class RoughnessMapping {
    square,    ///< r^2: widths such as alpha and m
    linear,    ///< r: parameters that are themselves called roughness
    exponent,  ///< 2 / r^4 - 2: cosine lobes of about the width r^2 (Walter et al. 2007, 2.2)
};

struct LtcTableOptions {
    int size = 64;                    ///< of the published tables; from 2 to 1024
    std::string parameter = "alpha";  ///< or several, "ax,ay", which all get the value
    RoughnessMapping mapping = RoughnessMapping::square;
    /// Called from any thread with cells done and in all.
    std::function<void(std::size_t, std::size_t)> progress = {};
};

/// Linearly transformed cosines of a model over roughness and elevation.
struct LtcTable {
    std::string spec = {};  ///< of the model, without the parameter that runs
    std::string parameter = {};
    int size = 0;
    std::vector<double> values = {};   ///< of the parameter, by column: roughness x / (size - 1)
    std::vector<double> cosines = {};  ///< of wo, by row: 1 - (y / (size - 1))^2, at least cos 1.57
    std::vector<LtcLobe> cells = {};   ///< [row * size + column]

    const LtcLobe& cell(int row, int column) const { return cells[row * size + column]; }

    struct Summary {
        double meanError = 0, largestError = 0;  ///< LtcLobe::error over the cells
        double meanMisplaced = 0, largestUncertainty = 0;
        int unsettled = 0;  ///< cells whose fit did not converge
    };
    Summary summary() const;
};

/// Fits every cell of the table of "model[:key=value,…]", which leaves out the running parameter.
/// Values outside the range of the parameter are brought to its ends. Every column is a path from
/// wo at the normal to grazing, each cell starting from the one before turned with the mirror
/// direction; where cos theta_o falls by more than half between two rows, by steps in between.
/// Columns run in parallel; the result does not depend on the number of threads.
///
/// The model has to be isotropic, mirror-symmetric and grey: a table holds one lobe for all
/// colours, which the shader colours by F0. Magnitude and Fresnel part are Schlick's with F0 = 1 in
/// the model. Throws UsageError for a parameter that does not exist (naming those that do) or that
/// is given, and for a model that is not as above; NumericError as fitLtc.
LtcTable fitLtcTable(const std::string& spec, const LtcTableOptions& options = {});

/// The table's cosine of row y: published tables have rows in sqrt(1 - cos theta).
double ltcCosine(int row, int size);

}  // namespace hshfit::brdfs
