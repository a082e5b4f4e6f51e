#include <hshfit/gpu/containers/sidecar.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/checked_product.h>
#include <hshfit/coefficient_files/coefficient_formats.h>
#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace hshfit::gpu::inline containers {
namespace {

using Json = nlohmann::json;
using Fields = JsonFields;

constexpr int maxDepth = 8;
constexpr int maxSide = 1 << 14;   // the limit of OutgoingSet
constexpr double maxCount = 9e15;  // integers that a double holds

static_assert(checkedProduct({maxSide, maxSide, maxLayers, 4 * sizeof(float)}));

/// The head, checked as in coefficient files, and against the size of the texels.
CoefficientHead readHeadOf(const Texels& texels, const Fields& root, const std::string& file) {
    const int width = texels.width, height = texels.height;
    CoefficientHead head =
        readSharedHead(root, static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    if (head.outgoing.width != width || head.outgoing.height != height) {
        throw InputError(fmt::format("{}: 'data' is {} x {}; the outgoing directions are {} x {}",
                                     file, width, height, head.outgoing.width,
                                     head.outgoing.height));
    }
    return head;
}

Role readRole(const Fields& fields, const char* key) {
    for (const Role role : {Role::coefficients, Role::basis}) {
        if (fields.word(key) == roleName(role)) return role;
    }
    fields.fail("has to be 'coef' or 'basis'", key);
}

std::string readSha256(const Fields& fields) {
    const std::string text = fields.word("sha256");
    const auto hexadecimal = [](char c) {
        return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
    };
    if (text.size() != 64 || !std::all_of(text.begin(), text.end(), hexadecimal)) {
        fields.fail("has to be 64 lower-case hexadecimal digits", "sha256");
    }
    return text;
}

/// Sizes, number type and scales of texels.
Texels readTexels(const Fields& data) {
    Texels texels;
    texels.width = data.integer("width", 1, maxSide);
    texels.height = data.integer("height", 1, maxSide);
    texels.layers =
        static_cast<std::size_t>(data.integer("layers", 1, static_cast<int>(maxLayers)));
    texels.number = numberIn(data, "type");
    if (data.word("endian") != "little") data.fail("has to be 'little'", "endian");
    const double bytes = static_cast<double>(texels.count() * numberBytes(texels.number));
    if (data.number("bytes") != bytes) {
        data.fail(fmt::format("is {}; {} x {} x {} RGBA texels of {} have {}", data.number("bytes"),
                              texels.width, texels.height, texels.layers, numberName(texels.number),
                              bytes),
                  "bytes");
    }
    if (!isNormalised(texels.number)) {
        if (!data.at("scale").is_null()) data.fail("has to be null for floating point", "scale");
        return texels;
    }
    for (const auto& row : data.table("scale", texels.layers * 4, 2)) {
        texels.scales.push_back({row[0], row[1]});
    }
    return texels;
}

/// All functions of the basis, or the functions with m >= 0.
void readSlots(const Fields& root, Payload& payload) {
    const auto basis = bases::make(payload.head.basis, payload.head.order);
    const std::vector<double> stated = root.numbers("slots");
    for (const bool sines : {true, false}) {
        payload.slots.clear();
        for (int l = 0; l < payload.head.order; ++l) {
            for (int m = sines ? -l : 0; m <= l; ++m) {
                if (basis->has(l, m)) payload.slots.push_back(slotOf(l, m));
            }
        }
        if (std::equal(stated.begin(), stated.end(), payload.slots.begin(), payload.slots.end()))
            return;
    }
    root.fail("has to hold the slots of all functions of the basis, or of those with m >= 0",
              "slots");
}

/// The stored channels, one after the other. Only chroma may have fewer bands.
void readStored(const Fields& root, Payload& payload) {
    const std::vector<Fields> rows = root.objects("stored");
    const bool rgb = payload.packing == Packing::rgb;
    if (rows.size() != payload.head.channels.count() || (rgb && rows.size() > 4)) {
        root.fail(fmt::format("has {} channels, 'channels' {}", rows.size(),
                              payload.head.channels.count()),
                  "stored");
    }
    const int all = static_cast<int>(payload.slots.size());
    std::size_t layer = 0;
    for (const Fields& row : rows) {
        const bool cut = !rgb && payload.head.channels.kind == Channels::Kind::rgb && layer > 0;
        const auto slots = static_cast<std::size_t>(row.integer("slots", cut ? 1 : all, all));
        const int first = static_cast<int>(rgb ? 0 : layer);
        row.integer("first_layer", first, first);
        payload.stored.push_back({row.word("name"), slots, static_cast<std::size_t>(first)});
        layer += (slots + 3) / 4;
    }
    const std::size_t layers = rgb ? payload.slots.size() : layer;
    if (layers != payload.coefficients.layers) {
        root.fail(
            fmt::format("needs {} layers; 'data' has {}", layers, payload.coefficients.layers),
            "stored");
    }
    payload.toChannels = root.table("to_channels", rows.size(), rows.size());
}

Packing readPacking(const Fields& data) {
    for (const Packing packing : {Packing::coef4, Packing::rgb}) {
        if (data.word("layout") == packingName(packing)) return packing;
    }
    data.fail("has to be 'coef4-planar' or 'rgb'", "layout");
}

std::vector<ExportedFile> readFiles(const Fields& root) {
    std::vector<ExportedFile> files;
    for (const Fields& row : root.objects("files")) {
        ExportedFile file{.role = readRole(row, "role"),
                          .container = row.word("container"),
                          .path = row.fileName("path"),
                          .bytes = 0,
                          .sha256 = readSha256(row)};
        const double bytes = row.number("bytes");
        if (!(bytes >= 0 && bytes <= maxCount)) row.fail("is no size of a file", "bytes");
        file.bytes = static_cast<std::uint64_t>(bytes);
        const auto known = containers::catalog();
        if (std::none_of(known.begin(), known.end(),
                         [&](const Container& c) { return c.name == file.container; })) {
            row.fail(fmt::format("is '{}', which is no container", file.container.substr(0, 40)),
                     "container");
        }
        files.push_back(std::move(file));
    }
    return files;
}

Direction readDirection(const Fields& row, const char* key) {
    const auto v = row.numbers(key, 3);
    const double length = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    if (!(std::abs(length - 1) < 1e-5) || v[2] <= 0) {
        row.fail("has to be a unit vector above the horizon", key);
    }
    return {v[0], v[1], v[2]};
}

}  // namespace

std::vector<TestTriple> readSidecarTests(const JsonFields& root, std::size_t channels) {
    std::vector<TestTriple> tests;
    for (const Fields& row : root.objects("tests")) {
        tests.push_back(
            {readDirection(row, "wo"), readDirection(row, "wi"), row.numbers("value", channels)});
    }
    return tests;
}

SidecarIndex parseSidecarIndex(std::string_view text, const std::string& file) {
    const Json document = parseJson(text, file, maxDepth);
    const Fields root(document, "", file);
    requireFormat(root, "hshfit-gpu",
                  root.has("form") ? formSidecarVersion : payloadSidecarVersion);
    SidecarIndex index;
    index.coefficients = readTexels(root.object("data"));
    index.coefficientsSha256 = readSha256(root.object("data"));
    if (!root.at("basis_textures").is_null()) {
        const Fields data = root.object("basis_textures").object("data");
        index.basisTexels = readTexels(data);
        index.basisSha256 = readSha256(data);
    }
    index.files = readFiles(root);
    if (root.has("holds")) index.holds = readRole(root, "holds");
    if (root.has("form")) index.form = root.word("form");
    return index;
}

Payload parseSidecar(std::string_view text, const std::string& file, SidecarIndex index,
                     std::vector<TestTriple>& tests) {
    const Json document = parseJson(text, file, maxDepth);
    const Fields root(document, "", file);
    if (root.has("form")) root.fail("is no set of coefficients per outgoing direction", "form");
    Payload payload;
    payload.coefficients = std::move(index.coefficients);
    payload.head = readHeadOf(payload.coefficients, root, file);
    const Fields data = root.object("data");
    payload.packing = readPacking(data);
    readSlots(root, payload);
    readStored(root, payload);
    if (index.basisTexels) {
        const std::size_t layers = (payload.slots.size() + 3) / 4;
        if (index.basisTexels->layers != layers ||
            index.basisTexels->width != index.basisTexels->height) {
            root.fail(fmt::format("has to be square and have {} layers", layers), "basis_textures");
        }
        payload.basisTexels = std::move(index.basisTexels);
    }
    tests = readSidecarTests(root, payload.head.channels.count());
    return payload;
}

}  // namespace hshfit::gpu::inline containers
