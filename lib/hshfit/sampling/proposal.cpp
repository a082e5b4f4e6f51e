#include <hshfit/sampling/proposal.h>

#include <hshfit/error.h>
#include <hshfit/sampling/axis_lobes.h>
#include <hshfit/sampling/internal/folded.h>
#include <hshfit/sampling/visible_normals.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline sampling {
namespace {

class ProposalSampler final : public Sampler {
public:
    explicit ProposalSampler(Proposal proposal) : proposal_(std::move(proposal)) {}
    std::string_view name() const override { return "proposal"; }

    Sample sample(const Direction& wo, const Uniforms& u) const override {
        if (!(wo.z > 0)) return {};
        const ProposalMix mix = mixAt(proposal_, wo);
        double before = 0;
        for (std::size_t k = 0; k < 2; before += mix.share[k++]) {
            if (u[2] >= before + mix.share[k]) continue;
            const Direction wi = foldedUp(drawGgx(wo, mix.widthX[k], mix.widthY[k], u[0], u[1]));
            return at(mix, wo, mix.retro[k] ? mirrored(wi) : wi);
        }
        return at(mix, wo, cosine_->sample(wo, u).wi);
    }

    double pdf(const Direction& wo, const Direction& wi) const override {
        return aboveHorizon(wo, wi) ? density(mixAt(proposal_, wo), wo, wi) : 0;
    }

private:
    static double density(const ProposalMix& mix, const Direction& wo, const Direction& wi) {
        double sum = (1 - mix.share[0] - mix.share[1]) * wi.z / pi;
        for (std::size_t k = 0; k < 2; ++k) {
            if (mix.share[k] == 0) continue;
            const Direction up = mix.retro[k] ? mirrored(wi) : wi, down{up.x, up.y, -up.z};
            sum += mix.share[k] * (ggxDensity(wo, up, mix.widthX[k], mix.widthY[k]) +
                                   ggxDensity(wo, down, mix.widthX[k], mix.widthY[k]));
        }
        return sum;
    }

    static Sample at(const ProposalMix& mix, const Direction& wo, const Direction& wi) {
        return {wi, aboveHorizon(wo, wi) ? density(mix, wo, wi) : 0};
    }

    Proposal proposal_;
    std::shared_ptr<const Sampler> cosine_ = cosineSampler();
};

}  // namespace

double proposalWidth(std::uint8_t code) {
    static const auto widths = [] {
        std::array<double, 256> all{};
        for (std::size_t k = 0; k < all.size(); ++k)
            all[k] = 1e-4 * std::pow(2e4, static_cast<double>(k) / 255.0);
        return all;
    }();
    return widths[code];
}

bool Proposal::isotropic() const {
    return std::ranges::all_of(rows, [](const Row& row) {
        return row[0].widthX == row[0].widthY && row[1].widthX == row[1].widthY;
    });
}

double proposalPlace(const Direction& wo, std::size_t rows) {
    const double across = std::hypot(wo.x, wo.y), count = static_cast<double>(rows);
    // 1 - tan(theta / 2) = (1 + z - across) / (1 + z), without cancellation at the horizon.
    const double rest = wo.z * (1 + wo.z / (1 + across)) / (1 + wo.z);
    return std::clamp((1 - std::sqrt(rest)) * count - 0.5, 0.0, count - 1);
}

Direction directionOfRow(std::size_t row, std::size_t rows) {
    const double s = (static_cast<double>(row) + 0.5) / static_cast<double>(rows);
    // z = (1 - t^2) / (1 + t^2), 1 - t = (1 - s)^2.
    const double t = s * (2 - s), z = (1 - s) * (1 - s) * (1 + t) / (1 + t * t);
    return {2 * t / (1 + t * t), 0, z};
}

ProposalMix mixAt(const Proposal& proposal, const Direction& wo) {
    const std::size_t rows = proposal.rows.size();
    const double place = proposalPlace(wo, rows);
    const std::size_t cell = std::min(static_cast<std::size_t>(place), rows - 1);
    const double t = place - static_cast<double>(cell);
    const Proposal::Row &a = proposal.rows[cell], &b = proposal.rows[std::min(cell + 1, rows - 1)];
    const auto between = [t](double from, double to) { return from + t * (to - from); };
    ProposalMix mix{};
    for (std::size_t k = 0; k < 2; ++k) {
        mix.share[k] = between(a[k].share / 255.0, b[k].share / 255.0);
        mix.widthX[k] = between(proposalWidth(a[k].widthX), proposalWidth(b[k].widthX));
        mix.widthY[k] = between(proposalWidth(a[k].widthY), proposalWidth(b[k].widthY));
        mix.retro[k] = a[k].retro == 1;
    }
    return mix;
}

void checkProposal(const Proposal& proposal) {
    if (proposal.rows.empty() || proposal.rows.size() > mostProposalRows)
        throw UsageError(fmt::format("a proposal with {} elevations; it has 1 to {}",
                                     proposal.rows.size(), mostProposalRows));
    for (const Proposal::Row& row : proposal.rows) {
        const int share = row[0].share + row[1].share;
        if (share > mostProposalShare)
            throw UsageError(
                fmt::format("the lobes of a proposal have shares of {}/255; the cosine "
                            "needs 8, so that at most {} are left",
                            share, mostProposalShare));
        if (row[0].retro != 0 || row[1].retro > 1 || row[1].retro != proposal.rows[0][1].retro)
            throw UsageError(
                "the first lobe of a proposal is about the mirror direction, the second one about "
                "the same direction at all elevations");
    }
}

std::shared_ptr<const Sampler> proposalSampler(Proposal proposal) {
    checkProposal(proposal);
    return std::make_shared<ProposalSampler>(std::move(proposal));
}

}  // namespace hshfit::inline sampling
