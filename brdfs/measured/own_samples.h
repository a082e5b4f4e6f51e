#pragma once

#include <brdfs/measured/scattered/samples.h>
#include <hshfit/brdf/brdf.h>
#include <hshfit/brdf/directions.h>

#include <cstddef>
#include <memory>
#include <span>
#include <string>

namespace hshfit::brdfs {

/// Takes the cells of a table one after another.
class CellReceiver {
public:
    virtual ~CellReceiver() = default;
    /// About as many cells as this will be added.
    virtual void reserve(std::size_t cells) = 0;
    /// Counts a cell with a direction at or below the horizon.
    virtual void belowHorizon() = 0;
    /// Counts a cell that is marked as not measured in some channel.
    virtual void invalid() = 0;
    /// `f`: a value in 1/sr for each channel of the table. `measure`: the share of d(wi) d(wo) that
    /// the cell stands for, up to a factor that all cells of the table have in common.
    virtual void add(const DirectionPair& pair, std::span<const double> f, double measure) = 0;
};

/// Implemented by formats that are tables with cells in half and difference angles, whose values
/// fits can take as they are stored (brdfs/fit/fit_samples.h).
class HasCells {
public:
    virtual ~HasCells() = default;
    virtual void giveCells(CellReceiver& receiver) const = 0;
    /// Whether a fit takes the cells unless it is told otherwise. If not, it takes f at the nodes
    /// of a quadrature.
    virtual bool cellsAreDefault() const = 0;
    /// Whether f holds at all nodes of a quadrature, also at those that coverage() leaves out.
    virtual bool holdsBeyondCoverage() const { return false; }
};

/// Implemented by BRDFs that interpolate between measured pairs of directions, which fits,
/// projections and comparisons take instead of f between them.
class HasMeasuredPairs {
public:
    virtual ~HasMeasuredPairs() = default;
    virtual const Samples& samples() const = 0;
    /// The BRDF of the same pairs with values times a factor of at least 0, under another name.
    virtual std::unique_ptr<Brdf> scaled(double factor, std::string name) const = 0;
};

}  // namespace hshfit::brdfs
