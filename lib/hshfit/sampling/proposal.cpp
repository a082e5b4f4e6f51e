#include <hshfit/sampling/proposal.h>

#include <hshfit/error.h>
#include <hshfit/sampling/axis_lobes.h>
#include <hshfit/sampling/elevation_bins.h>
#include <hshfit/sampling/folded.h>
#include <hshfit/sampling/internal/target.h>
#include <hshfit/sampling/visible_normals.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

namespace hshfit::inline sampling {
namespace {

constexpr int mostShare = 247;

/// A lobe turned about the normal.
class Turned final : public Sampler {
public:
    explicit Turned(std::shared_ptr<const Sampler> lobe) : lobe_(std::move(lobe)) {}
    std::string_view name() const override { return "retro normals"; }
    Sample sample(const Direction& wo, const Uniforms& u) const override {
        const Sample s = lobe_->sample(wo, u);
        return {mirrored(s.wi), s.pdf};
    }
    double pdf(const Direction& wo, const Direction& wi) const override {
        return lobe_->pdf(wo, mirrored(wi));
    }

private:
    std::shared_ptr<const Sampler> lobe_;
};

std::shared_ptr<const Sampler> samplerOf(const ProposalLobe& lobe) {
    auto normals = ggxSampler(proposalWidth(lobe.widthX), proposalWidth(lobe.widthY));
    if (lobe.retro == 0) return normals;
    return std::make_shared<Turned>(std::move(normals));
}

class ProposalSampler final : public Sampler {
public:
    explicit ProposalSampler(const Proposal& proposal) {
        for (const Proposal::Row& row : proposal.rows) {
            Bin bin;
            for (const ProposalLobe& lobe : row) {
                bin.shares[bin.count] = lobe.share / 255.0;
                if (lobe.share > 0) bin.lobes[bin.count++] = samplerOf(lobe);
            }
            bins_.push_back(std::move(bin));
        }
    }
    std::string_view name() const override { return "proposal"; }

    Sample sample(const Direction& wo, const Uniforms& u) const override {
        if (!(wo.z > 0)) return {};
        const Bin& bin = bins_[elevationBin(wo, bins_.size())];
        double before = 0;
        for (std::size_t k = 0; k < bin.count; before += bin.shares[k++]) {
            if (u[2] >= before + bin.shares[k]) continue;
            const Direction wi = bin.lobes[k]->sample(wo, u).wi;
            return {wi, pdf(wo, wi)};
        }
        const Direction wi = cosineSampler()->sample(wo, u).wi;
        return {wi, pdf(wo, wi)};
    }

    double pdf(const Direction& wo, const Direction& wi) const override {
        if (!aboveHorizon(wo, wi)) return 0;
        const Bin& bin = bins_[elevationBin(wo, bins_.size())];
        double rest = 1, sum = 0;
        for (std::size_t k = 0; k < bin.count; ++k) {
            sum += bin.shares[k] * bin.lobes[k]->pdf(wo, wi);
            rest -= bin.shares[k];
        }
        return sum + rest * wi.z / pi;
    }

private:
    struct Bin {
        std::size_t count = 0;
        std::array<double, 2> shares = {};
        std::array<std::shared_ptr<const Sampler>, 2> lobes = {};
    };
    std::vector<Bin> bins_;
};

/// The search for the lobes of one bin.
class Search {
public:
    Search(std::vector<Target> targets, bool isotropic)
        : targets_(std::move(targets)), isotropic_(isotropic) {
        cosine_ = densitiesAt(*cosineSampler(), targets_);
    }

    Proposal::Row best() {
        if (std::ranges::all_of(targets_, [](const Target& t) { return !(t.total > 0); }))
            return {};
        std::vector<ProposalLobe> lobes;
        for (int lobe = 0; lobe < 2; ++lobe) {
            lobes.push_back({});
            choose(lobes, lobe, grid());
        }
        for (const int step : {6, 2})
            for (std::size_t lobe : {0, 1}) choose(lobes, lobe, around(lobes[lobe], step));
        return rounded(lobes);
    }

private:
    using Key = std::tuple<int, int, int>;

    const NodeDensities& densities(const ProposalLobe& lobe) {
        const Key key{lobe.widthX, lobe.widthY, lobe.retro};
        const auto found = known_.find(key);
        if (found != known_.end()) return found->second;
        return known_.emplace(key, densitiesAt(*samplerOf(lobe), targets_)).first->second;
    }

    LeastMoment mixed(const std::vector<ProposalLobe>& lobes, int steps) {
        std::vector<const NodeDensities*> parts{&cosine_};
        for (const ProposalLobe& lobe : lobes) parts.push_back(&densities(lobe));
        constexpr double least = (255 - mostShare) / 255.0;
        return leastSecondMoment(targets_, parts, least, steps);
    }

    /// Replaces one lobe by the candidate with the least moment.
    void choose(std::vector<ProposalLobe>& lobes, std::size_t which,
                const std::vector<ProposalLobe>& candidates) {
        double least = std::numeric_limits<double>::infinity();
        ProposalLobe winner = candidates.front();
        for (const ProposalLobe& candidate : candidates) {
            lobes[which] = candidate;
            const double moment = mixed(lobes, 6).moment;
            if (moment >= least) continue;
            least = moment;
            winner = candidate;
        }
        lobes[which] = winner;
    }

    std::vector<ProposalLobe> grid() const {
        std::vector<ProposalLobe> all;
        const auto add = [&](int x, int y, int retro) {
            all.push_back({0, static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y),
                           static_cast<std::uint8_t>(retro)});
        };
        for (int x = 0; x <= 255; x += 17)
            for (const int retro : {0, 1}) add(x, x, retro);
        if (isotropic_) return all;
        for (int x = 0; x <= 255; x += 51)
            for (int y = 0; y <= 255; y += 51)
                if (x != y) add(x, y, 0);
        return all;
    }

    std::vector<ProposalLobe> around(const ProposalLobe& lobe, int step) const {
        std::vector<ProposalLobe> all;
        const auto code = [](int value) {
            return static_cast<std::uint8_t>(std::clamp(value, 0, 255));
        };
        for (const int x : {0, -1, 1})
            for (const int y : {0, -1, 1}) {
                if (isotropic_ && x != y) continue;
                all.push_back(
                    {0, code(lobe.widthX + x * step), code(lobe.widthY + y * step), lobe.retro});
            }
        return all;
    }

    Proposal::Row rounded(const std::vector<ProposalLobe>& lobes) {
        const LeastMoment found = mixed(lobes, 40);
        Proposal::Row row;
        for (std::size_t k = 0; k < row.size(); ++k) {
            row[k] = lobes[k];
            row[k].share = static_cast<std::uint8_t>(found.shares[k + 1] * 255);
        }
        return row;
    }

    std::vector<Target> targets_;
    bool isotropic_;
    NodeDensities cosine_;
    std::map<Key, NodeDensities> known_;
};

}  // namespace

double proposalWidth(std::uint8_t code) {
    return 1e-4 * std::pow(2e4, code / 255.0);
}

Proposal fitProposal(const Brdf& brdf, const ProposalOptions& options) {
    Proposal proposal;
    proposal.rows.resize(options.elevations);
    tbb::parallel_for(std::size_t{0}, options.elevations, [&](std::size_t bin) {
        proposal.rows[bin] =
            Search(targetsOfBin(brdf, bin, options.elevations), brdf.laws().isotropic).best();
    });
    return proposal;
}

std::shared_ptr<const Sampler> proposalSampler(Proposal proposal) {
    if (proposal.rows.empty()) throw UsageError("a proposal without elevations; give one or more");
    for (const Proposal::Row& row : proposal.rows)
        if (row[0].share + row[1].share > mostShare)
            throw UsageError(
                fmt::format("the lobes of a proposal have shares of {}/255; the cosine "
                            "needs 8, so that at most {} are left",
                            row[0].share + row[1].share, mostShare));
    return std::make_shared<ProposalSampler>(proposal);
}

}  // namespace hshfit::inline sampling
