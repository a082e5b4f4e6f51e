#include <hshfit/gpu/proposals/proposal_shader.h>

#include <hshfit/error.h>
#include <hshfit/files/template_text.h>
#include <hshfit/gpu/language_words.h>
#include <hshfit/gpu/shader_data.h>
#include <hshfit/gpu/shader_text.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

namespace hshfit::embedded {
extern const std::string_view proposal_angle, proposal_comment, proposal_density, proposal_ggx,
    proposal_glsl, proposal_hlsl, proposal_metal, proposal_osl, proposal_row, proposal_sample,
    proposal_wgsl;
}  // namespace hshfit::embedded

namespace hshfit::gpu::inline proposals {
namespace {

using kainjow::mustache::data;

/// The place of wo between the rows.
void setPlace(std::size_t rows, data& page) {
    const auto count = static_cast<double>(rows);
    page.set("rowCount", std::to_string(rows));
    page.set("rows", shaderNumber(count));
    page.set("last", shaderNumber(count - 1));
    page.set("lastCell", shaderNumber(std::max(0.0, count - 2)));
}

/// A lobe of an isotropic proposal takes two numbers of a row's one vector, of another one three of
/// a vector of its own.
void setTable(const Proposal& proposal, data& page) {
    const bool isotropic = proposal.isotropic();
    std::vector<Proposal::Row> rows = proposal.rows;
    if (rows.size() == 1) rows.push_back(rows.front());  // every place lies between two rows
    std::vector<std::string> vectors;
    for (const Proposal::Row& row : rows) {
        std::vector<std::string> lanes;
        for (const ProposalLobe& lobe : row) {
            lanes.push_back(shaderNumber(lobe.share / 255.0));
            lanes.push_back(shaderNumber(proposalWidth(lobe.widthX)));
            if (isotropic) continue;
            lanes.push_back(shaderNumber(proposalWidth(lobe.widthY)));
            lanes.push_back("0.0");
        }
        for (std::size_t k = 0; k < lanes.size(); k += 4)
            vectors.push_back(
                fmt::format("{}, {}, {}, {}", lanes[k], lanes[k + 1], lanes[k + 2], lanes[k + 3]));
    }
    data table{data::type::list};
    for (const std::string& numbers : vectors) {
        data row;
        row.set("first", &numbers == &vectors.front());
        row.set("numbers", numbers);
        table.push_back(row);
    }
    page.set("table", table);
    page.set("isotropic", isotropic);
    page.set("count", std::to_string(vectors.size()));
    page.set("numbersInTable", std::to_string(4 * vectors.size()));
    setPlace(proposal.rows.size(), page);
    page.set("retro1", proposal.rows.front()[1].retro == 1);
    page.set("sign1", proposal.rows.front()[1].retro == 1 ? "0.0 - " : "");
}

std::string textFrom(Language language, data& page) {
    setPartials({{"comment", embedded::proposal_comment},
                 {"rowBody", embedded::proposal_row},
                 {"angleBody", embedded::proposal_angle},
                 {"ggxBody", embedded::proposal_ggx},
                 {"pdfBody", embedded::proposal_density},
                 {"sampleBody", embedded::proposal_sample}},
                page);
    const std::string_view text = textOf(
        language, {embedded::proposal_glsl, embedded::proposal_glsl, embedded::proposal_hlsl,
                   embedded::proposal_wgsl, embedded::proposal_metal, embedded::proposal_osl});
    return fmt::format("\n{}", rendered(text, page));
}

void setEfficiency(const std::vector<ProposalRow>& rows, data& page) {
    data list{data::type::list};
    for (const ProposalRow& row : rows) {
        const Efficiency& e = row.efficiency;
        const std::vector<double>& albedo = row.albedo ? *row.albedo : e.albedo;
        data line;
        line.set("theta", fmt::format("{:.0f}", degrees(polarAngle(e.wo))));
        line.set("albedo", fmt::format("{:.4f}", fmt::join(albedo, " ")));
        line.set("variance", fmt::format("{:.2g}", e.variance));
        line.set("largest", fmt::format("{:.3g}", e.largest));
        line.set("wasted", fmt::format("{:.2g}", 100 * e.wasted));
        list.push_back(line);
    }
    page.set("efficiency", list);
}

}  // namespace

std::string proposalSource(Language language, const ProposalRecord& record,
                           const ProposalShaderOptions& options) {
    checkPrefix(options.prefix);
    checkProposal(record.proposal);
    data page;
    setLanguageWords(language, options.prefix, page);
    const bool osl = language == Language::osl;
    page.set("open", osl ? options.prefix + "_proposalRow(" : options.prefix + "_proposal[");
    page.set("close", osl ? ")" : "]");
    page.set("cosine", options.cosine);
    setTable(record.proposal, page);
    setEfficiency(record.rows, page);
    return textFrom(language, page);
}

std::vector<double> proposalTexels(const Proposal& proposal) {
    checkProposal(proposal);
    if (!proposal.isotropic())
        throw UsageError("texels of a proposal have one width for each lobe: it is isotropic");
    std::vector<double> lanes;
    for (const Proposal::Row& row : proposal.rows)
        for (const ProposalLobe& lobe : row) {
            lanes.push_back(lobe.share);
            lanes.push_back(lobe.widthX + (lobe.retro == 1 ? 256 : 0));
        }
    return lanes;
}

std::string materialProposalSource(Language language, const MaterialProposals& proposals) {
    checkPrefix(proposals.prefix);
    if (language == Language::osl)
        throw UsageError("OSL reads no texture by whole numbers, so that a library has no shader");
    data page;
    setLanguageWords(language, proposals.prefix, page);
    page.set("materials", true);
    page.set("snippet", proposals.prefix);
    page.set("prefix", proposals.prefix + "_material");
    page.set("first", std::to_string(proposals.first));
    page.set("second", std::to_string(proposals.first + 1));
    setPlace(proposals.rows, page);
    // proposalWidth as a power of two.
    page.set("widthStep", shaderNumber(std::log2(2e4) / 255));
    page.set("widthFirst", shaderNumber(-std::log2(1e-4)));
    page.set("retro1", true);
    page.set("sign1", "side * ");
    return textFrom(language, page);
}

}  // namespace hshfit::gpu::inline proposals
