#include <hshfit/gpu/proposals/proposal_record.h>

#include <hshfit/brdf/directions.h>
#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/gpu/containers/sidecar.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace hshfit::gpu::inline proposals {
namespace {

using Json = nlohmann::ordered_json;

constexpr int proposalVersion = 1;
constexpr std::size_t testCount = 16;
constexpr double testTolerance = 1e-9;

Json words() {
    return {
        {"density",
         "pdf(wo, wi) = (1 - share_0 - share_1) cos(theta_i) / pi + sum_k share_k (g_k(wi) + "
         "g_k(wi mirrored at the horizon)), per steradian"},
        {"lobe",
         "g(wi) = 1 / (2 pi ax ay s^2 (z + sqrt((ax x)^2 + (ay y)^2 + z^2))), (x, y, z) = wo, s "
         "= (h.x / ax)^2 + (h.y / ay)^2 + h.z^2, h the unit vector along wo + wi, 0 where its "
         "z <= 0; a retro lobe takes (-wi.x, -wi.y, wi.z) for wi"},
        {"place",
         "x = rows (1 - sqrt(1 - tan(theta_o / 2))) - 1/2, clamped to 0 .. rows - 1; shares and "
         "widths, not codes, are interpolated linearly between rows floor(x) and floor(x) + 1"},
        {"codes", "share = code / 255, width = 1e-4 * 20000^(code / 255)"},
        {"sample",
         "u3 chooses lobe 0, lobe 1 or the cosine, in this order; u1 and u2 go to the lobe "
         "(Dupuy & Benyoub 2023) or to the concentric map of a disc (Shirley & Chiu 1997)"}};
}

Json vectorJson(const Direction& d) {
    return {d.x, d.y, d.z};
}

/// Directions over the whole range of elevations, azimuths and numbers: the additive sequence R5
/// of Roberts 2018, "The unreasonable effectiveness of quasirandom sequences".
struct Draw {
    Direction wo;
    Uniforms u;
};
std::vector<Draw> draws() {
    constexpr double root = 1.1347241384015194;  // of x^6 = x + 1
    std::vector<Draw> all;
    for (std::size_t k = 0; k < testCount; ++k) {
        const auto part = [&](int axis) {
            const double value = 0.5 + static_cast<double>(k + 1) * std::pow(root, -axis);
            return value - std::floor(value);
        };
        all.push_back({directionFromAngles(radians(89) * part(1), 2 * pi * part(2)),
                       {part(3), part(4), part(5)}});
    }
    return all;
}

Json testsJson(const Sampler& sampler) {
    Json rows = Json::array();
    for (const Draw& draw : draws()) {
        const Sample s = sampler.sample(draw.wo, draw.u);
        rows.push_back({{"wo", vectorJson(draw.wo)},
                        {"u", {draw.u[0], draw.u[1], draw.u[2]}},
                        {"wi", vectorJson(s.wi)},
                        {"pdf", s.pdf}});
    }
    return rows;
}

Json efficiencyJson(const std::vector<ProposalRow>& rows) {
    Json list = Json::array();
    for (const ProposalRow& row : rows) {
        const Efficiency& e = row.efficiency;
        list.push_back({{"wo", vectorJson(e.wo)},
                        {"samples", e.samples},
                        {"albedo", row.albedo ? Json(*row.albedo) : Json(nullptr)},
                        {"estimate", e.albedo},
                        {"standard_error", e.albedoError},
                        {"variance", e.variance},
                        {"largest", e.largest},
                        {"wasted", e.wasted}});
    }
    return list;
}

Direction vectorOf(const JsonFields& row, const char* key) {
    const std::vector<double> v = row.numbers(key, 3);
    return {v[0], v[1], v[2]};
}

Proposal rowsOf(const JsonFields& fields) {
    const std::vector<std::string> kinds = fields.words("lobes");
    if (kinds.size() != 2 || kinds[0] != "mirror" || (kinds[1] != "mirror" && kinds[1] != "retro"))
        fields.fail("has to be 'mirror', and 'mirror' or 'retro'", "lobes");
    const nlohmann::json& list = fields.at("rows");
    if (!list.is_array() || list.empty() || list.size() > mostProposalRows)
        fields.fail(fmt::format("has to be 1 to {} rows", mostProposalRows), "rows");
    const auto table = fields.table("rows", list.size(), 6);
    Proposal proposal;
    for (const std::vector<double>& codes : table) {
        Proposal::Row row;
        for (const double code : codes)
            if (!(code >= 0 && code <= 255 && code == std::floor(code)))
                fields.fail("has to hold whole numbers from 0 to 255", "rows");
        const auto byte = [](double code) { return static_cast<std::uint8_t>(code); };
        for (std::size_t k = 0; k < 2; ++k)
            row[k] = {byte(codes[3 * k]), byte(codes[3 * k + 1]), byte(codes[3 * k + 2]),
                      static_cast<std::uint8_t>(kinds[k] == "retro")};
        proposal.rows.push_back(row);
    }
    try {
        checkProposal(proposal);
    } catch (const UsageError& error) {
        fields.fail(error.what(), "rows");
    }
    return proposal;
}

ProposalRow efficiencyOf(const JsonFields& row) {
    ProposalRow result{{.wo = vectorOf(row, "wo"),
                        .samples = static_cast<std::size_t>(row.integer("samples", 0, 1 << 30)),
                        .albedo = row.numbers("estimate"),
                        .albedoError = row.numbers("standard_error")}};
    result.efficiency.variance = row.number("variance", 0, 1e300);
    result.efficiency.largest = row.number("largest", 0, 1e300);
    result.efficiency.wasted = row.number("wasted", 0, 1);
    if (!row.at("albedo").is_null()) result.albedo = row.numbers("albedo");
    return result;
}

void checkTests(const JsonFields& fields, const Sampler& sampler) {
    for (const JsonFields& row : fields.objects("tests")) {
        const std::vector<double> u = row.numbers("u", 3);
        const Direction wo = vectorOf(row, "wo"), wi = vectorOf(row, "wi");
        const Sample s = sampler.sample(wo, {u[0], u[1], u[2]});
        const double pdf = sampler.pdf(wo, wi), stated = row.number("pdf");
        const double apart =
            std::max({std::abs(s.wi.x - wi.x), std::abs(s.wi.y - wi.y), std::abs(s.wi.z - wi.z)});
        if (!(apart <= testTolerance) || !(std::abs(pdf - stated) <= 1e-6 * stated))
            row.fail("differs from what the rows give", "wi");
    }
}

}  // namespace

std::string proposalText(const ProposalRecord& record) {
    checkProposal(record.proposal);
    Json document = {{"version", proposalVersion}};
    document.update(words());
    document["lobes"] = Json::array();
    for (const ProposalLobe& lobe : record.proposal.rows.front())
        document["lobes"].push_back(lobe.retro == 1 ? "retro" : "mirror");
    document["columns"] = {"share_0", "ax_0", "ay_0", "share_1", "ax_1", "ay_1"};
    document["rows"] = Json::array();
    for (const Proposal::Row& row : record.proposal.rows)
        document["rows"].push_back({row[0].share, row[0].widthX, row[0].widthY, row[1].share,
                                    row[1].widthX, row[1].widthY});
    document["weight"] = "mean over channels of |f| cos(theta_i) / pdf";
    document["efficiency"] = efficiencyJson(record.rows);
    document["tests"] = testsJson(*proposalSampler(record.proposal));
    return jsonText(document);
}

std::optional<ProposalRecord> parseProposal(const JsonFields& sidecar) {
    if (!sidecar.has("proposal")) return std::nullopt;
    const JsonFields fields = sidecar.object("proposal");
    fields.integer("version", proposalVersion, proposalVersion);
    ProposalRecord record{rowsOf(fields), {}};
    for (const JsonFields& row : fields.objects("efficiency"))
        record.rows.push_back(efficiencyOf(row));
    checkTests(fields, *proposalSampler(record.proposal));
    return record;
}

std::optional<ProposalRecord> parseProposal(std::string_view sidecar, const std::string& file) {
    constexpr int deepest = 8;
    const nlohmann::json document = parseJson(sidecar, file, deepest);
    return parseProposal(JsonFields(document, "", file));
}

std::optional<ProposalRecord> readProposal(const std::string& path) {
    const LoadedTexels loaded = loadTexels(path);
    return parseProposal(loaded.text, loaded.sidecar);
}

}  // namespace hshfit::gpu::inline proposals
