#pragma once

#include <hshfit/sampling/efficiency.h>
#include <hshfit/sampling/proposal.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline files {
class JsonFields;
}

namespace hshfit::gpu::inline proposals {

/// The efficiency of a proposal at one outgoing direction.
struct ProposalRow {
    Efficiency efficiency;
    /// The directional albedo by quadrature, per channel; none if it did not converge.
    std::optional<std::vector<double>> albedo = {};
};

/// A proposal as an export keeps it, for the f that the export evaluates to.
struct ProposalRecord {
    Proposal proposal;
    std::vector<ProposalRow> rows;  ///< by elevation, may be empty
};

/// The object "proposal" of a sidecar as JSON text (docs/schemas/gpu.schema.json): the
/// density in words and numbers, its efficiency, and directions drawn by the library for readers to
/// check themselves with.
std::string proposalText(const ProposalRecord& record);

/// The record of a sidecar; none if it has no "proposal". Throws InputError that names the field
/// for what is no proposal, and where the directions of its tests differ from the library's
/// by more than 1e-9.
std::optional<ProposalRecord> parseProposal(const JsonFields& sidecar);
/// The same for the text of a sidecar in `file`.
std::optional<ProposalRecord> parseProposal(std::string_view sidecar, const std::string& file);
/// The same for any file of an export (loadTexels). Throws InputError.
std::optional<ProposalRecord> readProposal(const std::string& path);

}  // namespace hshfit::gpu::inline proposals
