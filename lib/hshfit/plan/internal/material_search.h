#pragma once

#include <hshfit/plan/internal/ladder.h>
#include <hshfit/plan/internal/material_light.h>
#include <hshfit/plan/plan.h>
#include <hshfit/time_limit.h>
#include <hshfit/tradeoff/kept_projections.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::plan {

/// The search for the cheapest form of one material.
class MaterialSearch {
public:
    /// Costs are stated where there are `costs`.
    MaterialSearch(const Scene& scene, const Material& material, const BrdfOpener& open,
                   const PlanOptions& options, const gpu::ShaderCosts* costs,
                   const TimeLimit& limit);
    ~MaterialSearch();

    MaterialPlan run();

private:
    /// The material with one part split off, or none.
    struct Part {
        std::string added;                ///< as in Representation
        std::unique_ptr<Brdf> remainder;  ///< none: the version itself
        std::unique_ptr<tradeoff::KeptProjections> kept;
        std::vector<Radiance> addedRadiance;  ///< for each orientation; empty: none
        std::map<std::string, std::vector<double>> floor = {};  ///< [order - 1] by basis, quantity
    };
    /// The material as it is, or as one channel.
    struct Version {
        std::string spec;
        std::unique_ptr<Brdf> brdf;
        std::map<std::string, Part> parts;  ///< by Form::split
    };

    void addVersion(std::string spec, std::unique_ptr<Brdf> brdf);
    void addPart(Version& version, const std::string& split);
    void considerOneChannel();
    void describeLight();
    /// The least order beyond which the light's bands change L by less than a quarter of the
    /// budget, by the Cauchy-Schwarz inequality with the energy of f over `views`; else the
    /// highest.
    int usefulOrder(double energy, const Views& views, const std::vector<Radiance>& truth) const;
    void measureFloors(Part& part);
    void measureFloor(Part& part, Quantity quantity);

    Part& partOf(const Rung& rung) { return versions_[rung.source].parts.at(rung.form.split); }
    /// Outgoing radiance for each orientation.
    std::vector<Radiance> radianceOf(const Representation& representation, const Part& part);
    /// The error of the rung; none if the rung cannot be computed.
    std::optional<double> errorOf(const Rung& rung);
    /// Whether the rung has been tried and could be computed.
    bool wasTried(const Rung& rung) const;
    /// The error of the rung's truncation alone, from a few directions; 0 if not known.
    double floorOf(const Rung& rung);
    /// The error of the rung before its numbers are rounded.
    std::optional<double> unroundedError(const Rung& rung);
    /// Whether pictures of the rung's form, of kept projections, keep to the budget.
    bool looksRight(const Rung& rung);
    /// The source's pictures and pairs, drawn at the first call.
    const choice::RowMeasurement& measurement();
    const LatticeCheck& check();
    double toleranceOf(const Form& form) const;
    Choice choiceOf(const Rung& rung, double error) const;
    /// The choice with its FLIP, if the budget bounds it.
    Choice shownChoice(const Rung& rung, double error);
    /// The rung's coefficients, as the command makes them.
    Representation fileOf(const Rung& rung);
    /// Makes the file and verifies by lattice points; none if verification fails.
    std::optional<Accepted> accept(const Rung& rung);

    /// Tells a form within the budget that takes little time to find, before the search.
    void sayFirst();
    std::optional<std::size_t> firstWithin(std::size_t from);
    /// Moves the rung up if it takes more bytes than was foreseen; whether another is there now.
    bool makeWay(std::size_t place);
    void takeCheapest();
    void takeFastest();
    /// The largest halfway form in half, if it keeps to the budget.
    void takeLarge();
    /// Finds the cheaper and dearer choices; without an accepted choice, or time, the front of all
    /// tried rungs.
    void findNeighbours(std::size_t chosen);
    /// The least truncation error of any linear form.
    double leastFloor() const;
    void refuse();
    void measureFormulas();

    const Scene& scene_;
    const BrdfOpener& open_;
    const PlanOptions& options_;
    const gpu::ShaderCosts* costs_;
    const TimeLimit limit_;
    MaterialPlan plan_;
    std::vector<Version> versions_;
    std::unique_ptr<MaterialLight> light_;
    LadderOptions ladderOptions_;
    std::vector<Rung> rungs_;
    std::map<std::string, std::optional<double>> errors_;  ///< by source and form
    std::vector<double> lightBands_;                       ///< [l]: power of f's light in HSH
    int usefulOrder_ = 0;
    std::optional<choice::RowMeasurement> measurement_;
    std::optional<LatticeCheck> check_;
    std::map<std::string, bool> looksRight_;  ///< by source and form
    std::string lastFailure_;
};

}  // namespace hshfit::plan
