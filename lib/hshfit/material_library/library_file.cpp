#include <hshfit/material_library/library_file.h>

#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/files/tensor_file.h>
#include <hshfit/files/tensor_file_writer.h>
#include <hshfit/material_library/internal/log_samples.h>
#include <hshfit/material_library/log_terms.h>
#include <hshfit/version.h>
#include <hshfit/wording.h>

#include <Imath/half.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>

namespace hshfit::material_library {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Field = TensorFile::Field;

constexpr const char* format = "hshfit-library";
constexpr int newest = 1, deepestJson = 6;
constexpr std::size_t mostComponents = 512, mostHead = std::size_t{1} << 28;
constexpr std::size_t mostHalfway = std::size_t{1} << 22;
constexpr double highestTop = 60;  ///< e^60 is beyond every BRDF, and its square is finite

Json errorJson(const FormError& error) {
    return {{"mean_log", error.meanLog},       {"log", error.logError},
            {"relative_l2", error.relativeL2}, {"maximum", error.maximum},
            {"largest", error.largest},        {"flip", error.flip}};
}

FormError readError(const JsonFields& fields) {
    const auto value = [&](const char* key) { return fields.number(key, 0, largestNumber); };
    return {value("mean_log"), value("log"),     value("relative_l2"),
            value("maximum"),  value("largest"), value("flip")};
}

Json limitsJson(const Limits& limits) {
    return {{"log", limits.log}, {"maximum", limits.maximum}, {"flip", limits.flip}};
}

Limits readLimits(const JsonFields& fields) {
    const auto value = [&](const char* key) { return fields.number(key, 0, greatestLimit); };
    return {value("log"), value("maximum"), value("flip")};
}

std::string headOf(const Library& library) {
    Json materials = Json::array(), measured = Json::array();
    for (const Material& m : library.materials) {
        Json row = {{"name", m.name},         {"source", m.source}, {"kind", nameOf(m.kind)},
                    {"channels", m.channels}, {"bytes", m.bytes},   {"error", errorJson(m.error)}};
        if (m.kind == Kind::halfway) row["length"] = m.halfway.size();
        if (!m.fallback.empty()) row["fallback"] = m.fallback;
        materials.push_back(std::move(row));
    }
    for (const Measured& m : library.measured)
        measured.push_back({{"name", m.name},
                            {"source", m.source},
                            {"channels", m.channels()},
                            {"error", errorJson(m.error)}});
    Json head = {{"format", format},
                 {"version", newest},
                 {"generator", fmt::format("hshfit {}", version)},
                 {"terms", logTerms().size()},
                 {"step", library.basis.step},
                 {"limit", limitsJson(library.limits)},
                 {"unseen", {{"log", library.unseen}, {"flip", library.unseenFlip}}},
                 {"asked",
                  {{"components", library.asked.components},
                   {"bytes", library.asked.bytes},
                   {"held_out", library.asked.heldOut}}},
                 {"materials", std::move(materials)}};
    if (!library.basisFile.empty())
        head["basis"] = {{"file", library.basisFile}, {"sha256", library.basisSum}};
    if (!library.measured.empty()) head["measured"] = std::move(measured);
    return jsonText(head);
}

std::vector<float> asFloats(const std::vector<double>& values) {
    return {values.begin(), values.end()};
}

std::vector<std::uint16_t> asHalves(const std::vector<double>& values) {
    std::vector<std::uint16_t> halves;
    halves.reserve(values.size());
    for (const double value : values)
        halves.push_back(Imath::half(static_cast<float>(value)).bits());
    return halves;
}

/// Arrays of all materials one after another.
struct Joined {
    std::string codes, halfway;
    std::vector<double> polynomials, polynomialTops;
    std::vector<float> exponents, tops, rests;
};

Joined joinedOf(const Library& library) {
    Joined all;
    for (const Material& m : library.materials) {
        all.codes.append(m.codes.begin(), m.codes.end());
        all.halfway += m.halfway;
        if (m.kind != Kind::polynomial) continue;
        all.polynomials.insert(all.polynomials.end(), m.polynomial.exponents.begin(),
                               m.polynomial.exponents.end());
        all.polynomialTops.insert(all.polynomialTops.end(), m.polynomial.tops.begin(),
                                  m.polynomial.tops.end());
    }
    for (const Measured& m : library.measured) {
        all.exponents.insert(all.exponents.end(), m.exponents.begin(), m.exponents.end());
        all.tops.insert(all.tops.end(), m.tops.begin(), m.tops.end());
        all.rests.insert(all.rests.end(), m.rest.begin(), m.rest.end());
    }
    // Of files that did not say it the rest is not known.
    if (all.rests.size() != library.measured.size() * restRows) all.rests.clear();
    return all;
}

/// The fields of a file, with checks of their sizes and values.
class Reader {
public:
    Reader(std::span<const unsigned char> bytes, const std::string& name)
        : file_(bytes, name), name_(name) {}

    const std::string& name() const { return name_; }
    std::string head() const {
        const Field& field = file_.field(headField);
        if (field.type != TensorFile::Type::u8 || field.count > mostHead)
            file_.fail(field, fmt::format("has to be at most {} bytes of JSON", mostHead));
        const auto octets = file_.octets(field);
        return {reinterpret_cast<const char*>(octets.data()), octets.size()};
    }
    bool has(const char* key) const { return file_.find(key) != nullptr; }
    /// `count` bytes; a field of none may be absent.
    std::span<const unsigned char> octets(const char* key, std::size_t count) const {
        if (count == 0) return {};
        const Field& field = file_.field(key);
        if (field.type != TensorFile::Type::u8 || field.count != count)
            file_.fail(field, fmt::format("has {} values of type {}, expected {} of type u8",
                                          field.count, typeName(field.type), count));
        return file_.octets(field);
    }
    std::vector<float> floats(const char* key, std::size_t count) const {
        if (count == 0) return {};
        const Field& field = file_.field(key);
        if (field.count != count)
            file_.fail(field, fmt::format("has {} values, expected {}", field.count, count));
        return file_.floats(field, field.shape.size());
    }
    std::vector<double> halves(const char* key, std::size_t count) const {
        if (count == 0) return {};
        const Field& field = file_.field(key);
        if (field.type != TensorFile::Type::f16 || field.count != count)
            file_.fail(field, fmt::format("has {} values of type {}, expected {} of type f16",
                                          field.count, typeName(field.type), count));
        const auto raw = file_.raw(field);
        std::vector<double> values;
        values.reserve(count);
        for (std::size_t n = 0; n < count; ++n) {
            std::uint16_t bits = 0;
            std::memcpy(&bits, raw.data() + 2 * n, sizeof bits);
            const Imath::half value(Imath::half::FromBits, bits);
            if (!value.isFinite()) file_.fail(field, fmt::format("value {} is not finite", n));
            values.push_back(static_cast<float>(value));
        }
        return values;
    }
    std::vector<std::uint8_t> widths() const {
        const Field& field = file_.field("widths");
        if (field.count > mostComponents)
            file_.fail(field,
                       fmt::format("has {} components, more than {}", field.count, mostComponents));
        const auto raw = octets("widths", field.count);
        for (const unsigned char width : raw)
            if (width < 2 || width > 16)
                file_.fail(field, fmt::format("has a width of {} bits, expected 2 to 16", width));
        return {raw.begin(), raw.end()};
    }
    void requireTops(const std::vector<float>& tops, const char* key) const {
        for (const float top : tops)
            if (top > highestTop) fail(key, fmt::format("has {}, more than {}", top, highestTop));
    }
    [[noreturn]] void fail(const char* key, const std::string& reason) const {
        file_.fail(file_.field(key), reason);
    }

private:
    TensorFile file_;
    const std::string& name_;
};

Basis readBasis(const Reader& reader, const JsonFields& root) {
    Basis basis;
    if (!reader.has("widths")) return basis;
    basis.widths = reader.widths();
    basis.step = static_cast<float>(root.number("step", 1e-12, 1e6));
    const std::vector<float> mean = reader.floats("mean", logTerms().size());
    basis.mean.assign(mean.begin(), mean.end());
    basis.components = reader.halves("components", basis.size() * logTerms().size());
    return basis;
}

std::size_t readChannels(const JsonFields& row) {
    const int channels = row.integer("channels", 1, 3);
    if (channels == 2) row.fail("is 2, expected 1 or 3", "channels");
    return static_cast<std::size_t>(channels);
}

Kind readKind(const JsonFields& row) {
    const std::string word = row.word("kind");
    for (const Kind kind : {Kind::coded, Kind::polynomial, Kind::halfway})
        if (nameOf(kind) == word) return kind;
    row.fail(fmt::format("is '{}', expected coded, polynomial or halfway", word), "kind");
}

std::string readName(const JsonFields& row, const std::string& before) {
    const std::string name = row.word("name");
    try {
        requireName(name);
    } catch (const UsageError& error) {
        row.fail(error.what(), "name");
    }
    if (name <= before) row.fail(fmt::format("is '{}' after '{}'", name, before), "name");
    return name;
}

/// The rows without their arrays.
std::vector<Material> readRows(const JsonFields& root, const Basis& basis) {
    std::vector<Material> materials;
    for (const JsonFields& row : root.objects("materials")) {
        const std::string before = materials.empty() ? "" : materials.back().name;
        Material m{.name = readName(row, before),
                   .source = row.word("source"),
                   .kind = readKind(row),
                   .channels = readChannels(row),
                   .bytes = static_cast<std::size_t>(row.integer("bytes", 0, 1 << 30))};
        m.error = readError(row.object("error"));
        if (row.has("fallback")) m.fallback = row.word("fallback");
        if (m.kind == Kind::coded && basis.mean.empty())
            row.fail("is coded, in a file without a basis", "kind");
        if (m.kind == Kind::coded) m.codes.resize(m.channels * basis.channelBytes());
        if (m.kind == Kind::polynomial) m.polynomial.tops.resize(m.channels);
        if (m.kind == Kind::halfway)
            m.halfway.resize(
                static_cast<std::size_t>(row.integer("length", 2, static_cast<int>(mostHalfway))));
        materials.push_back(std::move(m));
    }
    return materials;
}

void fill(std::vector<Material>& materials, const Reader& reader) {
    std::size_t codes = 0, channels = 0, text = 0;
    for (const Material& m : materials) {
        codes += m.codes.size();
        channels += m.polynomial.tops.size();
        text += m.halfway.size();
    }
    const std::size_t terms = logTerms().size();
    const auto allCodes = reader.octets("codes", codes), allText = reader.octets("halfway", text);
    const std::vector<float> polynomials = reader.floats("polynomials", channels * terms);
    const std::vector<float> tops = reader.floats("polynomial_tops", channels);
    reader.requireTops(tops, "polynomial_tops");
    codes = channels = text = 0;
    for (Material& m : materials) {
        std::copy_n(allCodes.begin() + static_cast<std::ptrdiff_t>(codes), m.codes.size(),
                    m.codes.begin());
        std::copy_n(allText.begin() + static_cast<std::ptrdiff_t>(text), m.halfway.size(),
                    m.halfway.begin());
        const std::size_t count = m.polynomial.tops.size();
        m.polynomial.exponents.assign(
            polynomials.begin() + static_cast<std::ptrdiff_t>(channels * terms),
            polynomials.begin() + static_cast<std::ptrdiff_t>((channels + count) * terms));
        std::copy_n(tops.begin() + static_cast<std::ptrdiff_t>(channels), count,
                    m.polynomial.tops.begin());
        codes += m.codes.size();
        text += m.halfway.size();
        channels += count;
    }
}

std::vector<Measured> readMeasured(const JsonFields& root, const Reader& reader) {
    std::vector<Measured> all;
    if (!root.has("measured")) return all;
    std::size_t channels = 0;
    for (const JsonFields& row : root.objects("measured")) {
        Measured m{.name = readName(row, all.empty() ? "" : all.back().name),
                   .source = row.word("source"),
                   .exponents = {},
                   .tops = std::vector<float>(readChannels(row)),
                   .error = readError(row.object("error"))};
        channels += m.channels();
        all.push_back(std::move(m));
    }
    const std::size_t terms = logTerms().size();
    const std::vector<float> exponents = reader.floats("exponents", channels * terms),
                             tops = reader.floats("tops", channels),
                             rests = reader.floats("rests",
                                                   reader.has("rests") ? all.size() * restRows : 0);
    reader.requireTops(tops, "tops");
    for (const float rest : rests)
        if (rest < 0) reader.fail("rests", fmt::format("has {}, expected 0 or more", rest));
    for (std::size_t n = 0; n < rests.size(); ++n) all[n / restRows].rest.push_back(rests[n]);
    channels = 0;
    for (Measured& m : all) {
        const auto first = static_cast<std::ptrdiff_t>(channels);
        std::copy_n(tops.begin() + first, m.channels(), m.tops.begin());
        channels += m.channels();
        m.exponents.assign(exponents.begin() + first * static_cast<std::ptrdiff_t>(terms),
                           exponents.begin() + static_cast<std::ptrdiff_t>(channels * terms));
    }
    return all;
}

}  // namespace

void writeLibrary(const Library& library, AtomicFile& file) {
    const std::string head = headOf(library);
    const Joined all = joinedOf(library);
    const std::uint64_t terms = logTerms().size();
    const std::vector<float> mean = asFloats(library.basis.mean),
                             polynomials = asFloats(all.polynomials),
                             polynomialTops = asFloats(all.polynomialTops);
    const std::vector<std::uint16_t> components = asHalves(library.basis.components);
    TensorFileWriter writer;
    writer.add(headField, head);
    const std::string widths(library.basis.widths.begin(), library.basis.widths.end());
    if (library.basisFile.empty() && !library.basis.mean.empty()) {
        writer.add("mean", {terms}, mean);
        writer.add("components", TensorFile::Type::f16, {library.basis.size(), terms},
                   std::as_bytes(std::span(components)));
        writer.add("widths", widths);
    }
    if (!all.codes.empty()) writer.add("codes", all.codes);
    if (!all.halfway.empty()) writer.add("halfway", all.halfway);
    if (!polynomials.empty()) {
        writer.add("polynomials", {polynomialTops.size(), terms}, polynomials);
        writer.add("polynomial_tops", {polynomialTops.size()}, polynomialTops);
    }
    if (!all.tops.empty()) {
        writer.add("exponents", {all.tops.size(), terms}, all.exponents);
        writer.add("tops", {all.tops.size()}, all.tops);
    }
    if (!all.rests.empty()) writer.add("rests", {library.measured.size(), restRows}, all.rests);
    writer.write(file);
}

Library parseLibrary(std::span<const unsigned char> bytes, const std::string& name,
                     const std::function<Basis(const std::string& file)>& basisOf) {
    const Reader reader(bytes, name);
    const nlohmann::json document = parseJson(reader.head(), name, deepestJson);
    const JsonFields root(document, "", name);
    if (root.word("format") != format) root.fail(fmt::format("is not '{}'", format), "format");
    root.integer("version", 1, newest);
    const int terms = static_cast<int>(logTerms().size());
    root.integer("terms", terms, terms);
    const JsonFields unseen = root.object("unseen");
    Library library{.limits = readLimits(root.object("limit")),
                    .unseen = unseen.number("log", 0, largestNumber),
                    .unseenFlip = unseen.number("flip", 0, 1)};
    const JsonFields asked = root.object("asked");
    library.asked = {.components = static_cast<std::size_t>(
                         asked.integer("components", 0, static_cast<int>(mostComponents))),
                     .bytes = static_cast<std::size_t>(asked.integer("bytes", 0, 1 << 20)),
                     .heldOut = asked.number("held_out", 0, 1)};
    if (root.has("basis")) {
        const JsonFields basis = root.object("basis");
        library.basisFile = basis.word("file");
        library.basisSum = basis.word("sha256");
        library.basis = basisOf(library.basisFile);
        if (checksum(library.basis) != library.basisSum)
            throw InputError(
                fmt::format("{}: was encoded with another basis than {} has now: "
                            "encode it again, or keep the library that it is of",
                            name, library.basisFile));
    } else {
        library.basis = readBasis(reader, root);
    }
    library.materials = readRows(root, library.basis);
    fill(library.materials, reader);
    library.measured = readMeasured(root, reader);
    return library;
}

Library readLibrary(const std::string& path) {
    const MappedFile file(path);
    const auto basisOf = [&](const std::string& other) {
        const std::string there = (fs::path(path).parent_path() / other).string();
        const MappedFile from(there);
        const Reader reader(from.bytes(), there);
        const nlohmann::json document = parseJson(reader.head(), there, deepestJson);
        const JsonFields root(document, "", there);
        if (root.has("basis")) root.fail("names a third file", "basis");
        return readBasis(reader, root);
    };
    if (!looksLikeLibrary(file.bytes().first(std::min<std::size_t>(file.size(), 64))))
        throw InputError(
            fmt::format("{}: is no library of materials; {} makes one", path, Call{"learn"}));
    try {
        Library library = parseLibrary(file.bytes(), path, basisOf);
        file.checkIntact();
        return library;
    } catch (const InputError&) {
        file.checkIntact();
        throw;
    }
}

}  // namespace hshfit::material_library
