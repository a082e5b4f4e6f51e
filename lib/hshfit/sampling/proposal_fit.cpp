#include <hshfit/sampling/proposal.h>

#include <hshfit/sampling/axis_lobes.h>
#include <hshfit/sampling/internal/folded.h>
#include <hshfit/sampling/internal/target.h>
#include <hshfit/sampling/visible_normals.h>
#include <hshfit/stop_request.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

namespace hshfit::inline sampling {
namespace {

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

/// The best row with a second lobe of one kind, and the second moment that it leaves.
struct Found {
    Proposal::Row row;
    double moment = 1;
};

/// The search for the lobes of one bin.
class Search {
public:
    Search(std::vector<Target> targets, bool isotropic)
        : targets_(std::move(targets)), isotropic_(isotropic) {
        cosine_ = densitiesAt(*cosineSampler(), targets_);
    }

    bool reflects() const {
        return std::ranges::any_of(targets_, [](const Target& t) { return t.total > 0; });
    }

    /// The first lobe is about the mirror direction.
    Found best(bool retro) {
        std::vector<ProposalLobe> lobes;
        for (std::size_t lobe : {0, 1}) {
            lobes.push_back({});
            choose(lobes, lobe, grid(retro && lobe == 1));
        }
        for (const int step : {6, 2})
            for (std::size_t lobe : {0, 1}) choose(lobes, lobe, around(lobes[lobe], step));
        return rounded(lobes, retro);
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
        constexpr double least = (255 - mostProposalShare) / 255.0;
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

    std::vector<ProposalLobe> grid(bool retro) const {
        std::vector<ProposalLobe> all;
        const auto add = [&](int x, int y) {
            all.push_back({0, static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y),
                           static_cast<std::uint8_t>(retro)});
        };
        for (int x = 0; x <= 255; x += 17) add(x, x);
        if (isotropic_) return all;
        for (int x = 0; x <= 255; x += 51)
            for (int y = 0; y <= 255; y += 51)
                if (x != y) add(x, y);
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

    Found rounded(const std::vector<ProposalLobe>& lobes, bool retro) {
        const LeastMoment found = mixed(lobes, 40);
        Found best{{}, found.moment};
        for (std::size_t k = 0; k < 2; ++k) {
            best.row[k] = lobes[k];
            best.row[k].share = static_cast<std::uint8_t>(found.shares[k + 1] * 255);
        }
        // Lobes of one kind are in order of width, so that neighbouring rows agree.
        const auto size = [](const ProposalLobe& lobe) { return lobe.widthX + lobe.widthY; };
        if (!retro && size(best.row[0]) > size(best.row[1])) std::swap(best.row[0], best.row[1]);
        return best;
    }

    std::vector<Target> targets_;
    bool isotropic_;
    NodeDensities cosine_;
    std::map<Key, NodeDensities> known_;
};

/// A lobe without a share has the widths of the nearest row in which it has one: between such rows
/// it grows from nothing at its own width.
void fillWidths(Proposal& proposal, std::size_t lobe) {
    const std::vector<Proposal::Row> before = proposal.rows;
    const auto count = static_cast<std::ptrdiff_t>(before.size());
    for (std::ptrdiff_t row = 0; row < count; ++row) {
        std::ptrdiff_t nearest = count;
        for (std::ptrdiff_t other = 0; other < count; ++other)
            if (before[static_cast<std::size_t>(other)][lobe].share > 0 &&
                (nearest == count || std::abs(other - row) < std::abs(nearest - row)))
                nearest = other;
        if (nearest == count || nearest == row) continue;
        ProposalLobe& filled = proposal.rows[static_cast<std::size_t>(row)][lobe];
        filled.widthX = before[static_cast<std::size_t>(nearest)][lobe].widthX;
        filled.widthY = before[static_cast<std::size_t>(nearest)][lobe].widthY;
    }
}

}  // namespace

Proposal fitProposal(const Brdf& brdf, const ProposalOptions& options) {
    const std::size_t count = options.elevations;
    std::vector<std::array<Found, 2>> found(count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t row) {
        stopIfRequested();
        const Direction wo = directionOfRow(row, count);
        Search search(targetsAtHeight(brdf, wo.z, wo.x), brdf.laws().isotropic);
        if (search.reflects()) found[row] = {search.best(false), search.best(true)};
    });
    double gain = 0;  // of the second lobe as a retro one
    for (const auto& [mirror, retro] : found) gain += std::log(mirror.moment / retro.moment);
    const std::size_t kind = gain > 0 ? 1 : 0;
    Proposal proposal;
    for (const auto& row : found) {
        proposal.rows.push_back(row[kind].row);
        proposal.rows.back()[1].retro = static_cast<std::uint8_t>(kind);
    }
    for (const std::size_t lobe : {0, 1}) fillWidths(proposal, lobe);
    return proposal;
}

}  // namespace hshfit::inline sampling
