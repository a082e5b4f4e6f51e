#include <hshfit/material_library/library_file.h>

#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/files/tensor_file.h>
#include <hshfit/material_library/internal/library_format.h>
#include <hshfit/material_library/internal/log_samples.h>
#include <hshfit/material_library/log_terms.h>
#include <hshfit/wording.h>

#include <Imath/half.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>

namespace hshfit::material_library {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Field = TensorFile::Field;

constexpr int deepestJson = 6;
constexpr std::size_t mostComponents = 512, mostHead = std::size_t{1} << 28;
constexpr std::size_t mostHalfway = std::size_t{1} << 22;
constexpr std::size_t rowsWithoutRelease = 4096;
constexpr double highestTop = 60;  ///< e^60 is beyond every BRDF, and its square is finite

FormError readError(const JsonFields& fields) {
    const auto value = [&](const char* key) { return fields.number(key, 0, largestNumber); };
    return {value("mean_log"), value("log"),     value("relative_l2"),
            value("maximum"),  value("largest"), value("flip")};
}

Limits readLimits(const JsonFields& fields) {
    const auto value = [&](const char* key) { return fields.number(key, 0, greatestLimit); };
    return {value("log"), value("maximum"), value("flip")};
}

/// The fields of a file, with checks of their sizes and values.
class Reader {
public:
    Reader(std::span<const unsigned char> bytes, const std::string& name)
        : file_(bytes, name), name_(name) {}

    const std::string& name() const { return name_; }
    std::string_view head() const {
        const Field& field = file_.field(headField);
        if (field.type != TensorFile::Type::u8 || field.count > mostHead)
            file_.fail(field, fmt::format("has to be at most {} bytes of JSON", mostHead));
        const auto octets = file_.octets(field);
        return {reinterpret_cast<const char*>(octets.data()), octets.size()};
    }
    bool has(const char* key) const { return file_.find(key) != nullptr; }
    std::vector<float> floats(const char* key, std::size_t count) const {
        const Field& field = file_.field(key);
        if (field.count != count)
            file_.fail(field, fmt::format("has {} values, expected {}", field.count, count));
        return file_.floats(field, field.shape.size());
    }
    std::vector<double> halves(const char* key, std::size_t count) const {
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
        const auto raw = file_.octets(field);
        for (const unsigned char width : raw)
            if (width < 2 || width > 16)
                file_.fail(field, fmt::format("has a width of {} bits, expected 2 to 16", width));
        return {raw.begin(), raw.end()};
    }
    const TensorFile& file() const { return file_; }

private:
    TensorFile file_;
    const std::string& name_;
};

/// A field with numbers of all materials, one after another, as they are taken. A field of none may
/// be absent.
template <class Number>
class Sequence {
public:
    Sequence(const TensorFile& file, const char* key, TensorFile::Type type)
        : file_(file), key_(key), type_(type) {}

    /// The next `count` numbers, each of which `isValid`.
    template <class List, class Valid>
    void take(std::size_t count, List& list, const Valid& isValid) {
        if (count == 0) return;
        const Field& field = file_.field(key_);
        if (field.type != type_)
            file_.fail(field, fmt::format("has values of type {}, expected {}",
                                          typeName(field.type), typeName(type_)));
        if (field.count - taken_ < count)
            file_.fail(field, fmt::format("has {} values, fewer than its materials", field.count));
        list.resize(count);
        std::memcpy(list.data(), file_.raw(field).data() + taken_ * sizeof(Number),
                    count * sizeof(Number));
        for (std::size_t n = 0; n < count; ++n)
            if (!isValid(list[n]))
                file_.fail(field, fmt::format("value {} is {}", taken_ + n, list[n]));
        taken_ += count;
    }
    /// Throws where the field has more.
    void requireEnd() const {
        if (taken_ == 0) return;
        const Field& field = file_.field(key_);
        if (field.count != taken_)
            file_.fail(field, fmt::format("has {} values, expected {}", field.count, taken_));
    }

private:
    const TensorFile& file_;
    const char* key_;
    TensorFile::Type type_;
    std::uint64_t taken_ = 0;
};

bool isNumber(float value) {
    return std::isfinite(value);
}

bool isTop(float value) {
    return std::isfinite(value) && value <= highestTop;
}

bool isSquare(float value) {
    return std::isfinite(value) && value >= 0;
}

bool isOctet(unsigned char) {
    return true;
}

int readVersion(const JsonFields& root) {
    return root.integer("version", 1, newestLibrary);
}

Basis readBasis(const Reader& reader, const JsonFields& root) {
    Basis basis;
    if (!reader.has("widths")) return basis;
    basis.widths = reader.widths();
    basis.step = static_cast<float>(root.number("step", 1e-12, 1e6));
    basis.scaled = readVersion(root) > versionWithoutScales;
    const std::vector<float> mean = reader.floats("mean", logTerms().size());
    basis.mean.assign(mean.begin(), mean.end());
    if (basis.size() > 0)
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

/// The name of a row; `last` is the name of the row before, and becomes this one.
std::string readName(const JsonFields& row, std::string& last) {
    const std::string name = row.word("name");
    try {
        requireName(name);
    } catch (const UsageError& error) {
        row.fail(error.what(), "name");
    }
    if (name <= last) row.fail(fmt::format("is '{}' after '{}'", name, last), "name");
    last = name;
    return name;
}

/// The materials of a library, row by row.
class MaterialRows {
public:
    MaterialRows(const Reader& reader, const Basis& basis) : basis_(basis), reader_(reader) {}

    Material next(const JsonFields& row) {
        Material m{.name = readName(row, last_),
                   .source = row.word("source"),
                   .kind = readKind(row),
                   .channels = readChannels(row),
                   .bytes = static_cast<std::size_t>(row.integer("bytes", 0, 1 << 30))};
        m.error = readError(row.object("error"));
        if (row.has("fallback")) m.fallback = row.word("fallback");
        switch (m.kind) {
            case Kind::coded:
                if (basis_.mean.empty()) row.fail("is coded, in a file without a basis", "kind");
                codes_.take(m.channels * basis_.channelBytes(), m.codes, isOctet);
                break;
            case Kind::polynomial:
                m.polynomial = nextPolynomial(m.channels);
                break;
            case Kind::halfway:
                halfway_.take(static_cast<std::size_t>(
                                  row.integer("length", 2, static_cast<int>(mostHalfway))),
                              m.halfway, isOctet);
                break;
        }
        return m;
    }
    void requireEnd() const {
        codes_.requireEnd();
        halfway_.requireEnd();
        polynomials_.requireEnd();
        tops_.requireEnd();
    }

private:
    LogMaterial nextPolynomial(std::size_t channels) {
        std::vector<float> exponents, tops;
        polynomials_.take(channels * logTerms().size(), exponents, isNumber);
        tops_.take(channels, tops, isTop);
        return {{exponents.begin(), exponents.end()}, {tops.begin(), tops.end()}};
    }

    const Basis& basis_;
    const Reader& reader_;
    std::string last_;
    Sequence<unsigned char> codes_{reader_.file(), "codes", TensorFile::Type::u8},
        halfway_{reader_.file(), "halfway", TensorFile::Type::u8};
    Sequence<float> polynomials_{reader_.file(), "polynomials", TensorFile::Type::f32},
        tops_{reader_.file(), "polynomial_tops", TensorFile::Type::f32};
};

/// The materials that learning again needs, row by row.
class MeasuredRows {
public:
    explicit MeasuredRows(const Reader& reader) : reader_(reader) {}

    Measured next(const JsonFields& row) {
        Measured m{.name = readName(row, last_),
                   .source = row.word("source"),
                   .exponents = {},
                   .tops = {},
                   .error = readError(row.object("error"))};
        const std::size_t channels = readChannels(row);
        exponents_.take(channels * logTerms().size(), m.exponents, isNumber);
        tops_.take(channels, m.tops, isTop);
        if (hasRests_) rests_.take(restRows, m.rest, isSquare);
        return m;
    }
    void requireEnd() const {
        exponents_.requireEnd();
        tops_.requireEnd();
        rests_.requireEnd();
    }

private:
    const Reader& reader_;
    std::string last_;
    bool hasRests_ = reader_.has("rests");
    Sequence<float> exponents_{reader_.file(), "exponents", TensorFile::Type::f32},
        tops_{reader_.file(), "tops", TensorFile::Type::f32},
        rests_{reader_.file(), "rests", TensorFile::Type::f32};
};

/// The arrays of a head whose elements are one material each.
constexpr std::array<std::string_view, 2> rowArrays{"materials", "measured"};

using RowCall = std::function<void(std::string_view array, const JsonFields& row)>;

/// Calls `call(array, row)` for each row, and leaves the arrays of the head empty: a tree of all
/// rows takes kilobytes a material.
Json parseHead(std::string_view text, const std::string& name, const RowCall& call) {
    std::string key;
    bool inRows = false;
    std::size_t count = 0;
    return parseJson(text, name, deepestJson, [&](int depth, Json::parse_event_t event, Json& at) {
        using Event = Json::parse_event_t;
        if (depth == 1) {
            if (event == Event::key) key = at.get<std::string>();
            inRows = event == Event::array_start && std::ranges::count(rowArrays, key) > 0;
            count = 0;
        }
        const bool ends =
            event == Event::object_end || event == Event::array_end || event == Event::value;
        if (!inRows || depth != 2 || !ends) return true;
        if (call) call(key, JsonFields(at, fmt::format("{}[{}]", key, count), name));
        ++count;
        return false;
    });
}

/// Reads a library and hands its materials on. Calls `passed` after each row, of which each is read
/// twice: the basis that codes need may be named behind them.
Library parse(const Reader& reader, const std::string& name, const BasisOf& basisOf,
              const LibraryCalls& calls, const std::function<void()>& passed) {
    const auto pass = [&](std::string_view, const JsonFields&) { passed(); };
    const Json document = parseHead(reader.head(), name, pass);
    const JsonFields root(document, "", name);
    if (root.word("format") != libraryFormat)
        root.fail(fmt::format("is not '{}'", libraryFormat), "format");
    readVersion(root);
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
    root.objects("materials");  // throws for what is no array
    if (root.has("measured")) root.objects("measured");
    MaterialRows materials(reader, library.basis);
    MeasuredRows measured(reader);
    parseHead(reader.head(), name, [&](std::string_view array, const JsonFields& row) {
        if (array == "materials")
            calls.material(materials.next(row));
        else
            calls.measured(measured.next(row));
        passed();
    });
    materials.requireEnd();
    measured.requireEnd();
    return library;
}

/// The calls that keep all materials.
struct Kept {
    std::vector<Material> materials;
    std::vector<Measured> measured;

    LibraryCalls calls() {
        return {[this](Material m) { materials.push_back(std::move(m)); },
                [this](Measured m) { measured.push_back(std::move(m)); }};
    }
    Library in(Library library) {
        library.materials = std::move(materials);
        library.measured = std::move(measured);
        return library;
    }
};

}  // namespace

Library parseLibrary(std::span<const unsigned char> bytes, const std::string& name,
                     const BasisOf& basisOf) {
    Kept kept;
    return kept.in(parse(Reader(bytes, name), name, basisOf, kept.calls(), [] {}));
}

Library readLibrary(const std::string& path) {
    Kept kept;
    return kept.in(readLibrary(path, kept.calls()));
}

Library readLibrary(const std::string& path, const LibraryCalls& calls) {
    const MappedFile file(path);
    const auto basisOf = [&](const std::string& other) {
        const std::string there = (fs::path(path).parent_path() / other).string();
        const MappedFile from(there);
        const Reader reader(from.bytes(), there);
        const Json document = parseHead(reader.head(), there, {});
        const JsonFields root(document, "", there);
        if (root.has("basis")) root.fail("names a third file", "basis");
        return readBasis(reader, root);
    };
    if (!looksLikeLibrary(file.bytes().first(std::min<std::size_t>(file.size(), 64))))
        throw InputError(
            fmt::format("{}: is no library of materials; {} makes one", path, Call{"learn"}));
    // Pages that were read would stay in memory until the end.
    std::size_t count = 0;
    const auto passed = [&] {
        if (++count % rowsWithoutRelease == 0) file.releasePages();
    };
    try {
        Library library = parse(Reader(file.bytes(), path), path, basisOf, calls, passed);
        file.checkIntact();
        return library;
    } catch (const InputError&) {
        file.checkIntact();
        throw;
    }
}

}  // namespace hshfit::material_library
