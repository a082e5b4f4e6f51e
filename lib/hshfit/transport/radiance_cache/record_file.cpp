#include <hshfit/transport/radiance_cache/record_file.h>

#include <hshfit/brdf/directions.h>
#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/files/tensor_file_writer.h>
#include <hshfit/version.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace hshfit::inline transport::inline radiance_cache {
namespace {

constexpr const char* format = "hshfit-radiance-records";
constexpr std::size_t numbers = 18;  ///< float64 of each record

std::array<double, numbers> numbersOf(const Record& record) {
    const Point& position = record.position;
    const Frame& frame = record.frame;
    return {position[0],       position[1],       position[2],       frame.tangent.x,
            frame.tangent.y,   frame.tangent.z,   frame.bitangent.x, frame.bitangent.y,
            frame.bitangent.z, frame.normal.x,    frame.normal.y,    frame.normal.z,
            record.radius,     record.longRadius, record.distance,   record.longAxis.x,
            record.longAxis.y, record.longAxis.z};
}

Record recordOf(const double* n) {
    Record record;
    record.position = {n[0], n[1], n[2]};
    record.frame.tangent = {n[3], n[4], n[5]};
    record.frame.bitangent = {n[6], n[7], n[8]};
    record.frame.normal = {n[9], n[10], n[11]};
    record.radius = n[12];
    record.longRadius = n[13];
    record.distance = n[14];
    record.longAxis = {n[15], n[16], n[17]};
    return record;
}

bool sound(const Record& record) {
    const Frame& f = record.frame;
    for (const Direction& axis : {f.tangent, f.bitangent, f.normal, record.longAxis})
        if (!(std::abs(dot(axis, axis) - 1) < 1e-6)) return false;
    for (const double x : record.position)
        if (!std::isfinite(x)) return false;
    return std::abs(dot(f.tangent, f.normal)) < 1e-6 && record.radius > 0 &&
           std::isfinite(record.longRadius) && record.longRadius >= record.radius &&
           record.distance > 0;
}

template <class Value>
std::vector<Value> valuesOf(const TensorFile& file, const char* name, TensorFile::Type type,
                            std::uint64_t count) {
    const TensorFile::Field& field = file.field(name);
    if (field.type != type || field.count != count)
        file.fail(field, fmt::format("it has to hold {} values {}", count, typeName(type)));
    const std::span<const unsigned char> bytes = file.raw(field);
    std::vector<Value> values(count);
    if (count > 0) std::memcpy(values.data(), bytes.data(), count * sizeof(Value));
    return values;
}

/// The number of items of `of` values each.
std::uint64_t countOf(const TensorFile& file, const char* name, std::uint64_t of) {
    const TensorFile::Field& field = file.field(name);
    if (field.count % of != 0) file.fail(field, fmt::format("its size is no multiple of {}", of));
    return field.count / of;
}

}  // namespace

void writeRecords(const StoredRecords& stored, AtomicFile& file) {
    const nlohmann::ordered_json header = {{"format", format},
                                           {"version", 3},
                                           {"generator", std::string("hshfit ") + version},
                                           {"key", stored.key},
                                           {"orders", stored.orders},
                                           {"functions", stored.functions},
                                           {"spacing", stored.spacing}};
    const std::string text = jsonText(header);
    std::vector<double> places;
    std::vector<std::uint32_t> kinds, sides;
    std::vector<float> values, points;
    for (const Record& record : stored.records) {
        const auto all = numbersOf(record);
        places.insert(places.end(), all.begin(), all.end());
        kinds.push_back(record.kind);
        values.insert(values.end(), record.values.begin(), record.values.end());
    }
    for (const IrradiancePoint& point : stored.points) {
        for (const auto* three : {&point.position, &point.normal, &point.irradiance})
            points.insert(points.end(), three->begin(), three->end());
        sides.push_back(point.side);
    }
    TensorFileWriter writer;
    writer.add("header", text);
    writer.add("places", TensorFile::Type::f64, {kinds.size(), numbers},
               std::as_bytes(std::span(places)));
    writer.add("kinds", {kinds.size()}, kinds);
    writer.add("values", {values.size()}, values);
    writer.add("points", {stored.points.size(), 9}, points);
    writer.add("sides", {sides.size()}, sides);
    writer.write(file);
}

StoredRecords readRecords(const std::string& path, const std::string& key) {
    const MappedFile mapped(path);
    const TensorFile file(mapped.bytes(), path);
    const std::span<const unsigned char> text = file.octets(file.field("header"));
    const nlohmann::json parsed =
        parseJson({reinterpret_cast<const char*>(text.data()), text.size()}, path, 4);
    const JsonFields header(parsed, "", path);
    if (header.word("format") != format) header.fail("is no file of records", "format");
    header.integer("version", 3, 3);
    StoredRecords stored;
    stored.key = header.word("key");
    if (stored.key != key) {
        throw InputError(fmt::format(
            "{}: its records are of another scene, or of other settings of light or basis", path));
    }
    for (const double order : header.numbers("orders")) {
        if (!(order >= 0 && order <= 3000)) header.fail("holds what is no order", "orders");
        stored.orders.push_back(static_cast<int>(order));
    }
    for (const double count : header.numbers("functions", stored.orders.size())) {
        if (!(count >= 1 && count <= 9e6)) header.fail("holds what is no count", "functions");
        stored.functions.push_back(static_cast<std::size_t>(count));
    }
    stored.spacing = header.number("spacing", 0, 1e30);
    const std::uint64_t count = countOf(file, "places", numbers);
    const auto places = valuesOf<double>(file, "places", TensorFile::Type::f64, count * numbers);
    const auto kinds = valuesOf<std::uint32_t>(file, "kinds", TensorFile::Type::u32, count);
    const auto values =
        valuesOf<float>(file, "values", TensorFile::Type::f32, file.field("values").count);
    const auto points =
        valuesOf<float>(file, "points", TensorFile::Type::f32, 9 * countOf(file, "points", 9));
    const auto sides =
        valuesOf<std::uint32_t>(file, "sides", TensorFile::Type::u32, points.size() / 9);
    std::size_t used = 0;
    for (std::size_t k = 0; k < count; ++k) {
        Record record = recordOf(places.data() + k * numbers);
        if (!sound(record)) file.fail(file.field("places"), fmt::format("record {} is broken", k));
        if (kinds[k] >= stored.functions.size())
            file.fail(file.field("kinds"), fmt::format("record {} is of no kind", k));
        record.kind = kinds[k];
        const std::size_t parts = stored.orders[record.kind] == 0 ? 5 : 3;
        const std::size_t size = parts * 3 * stored.functions[record.kind];
        if (values.size() - used < size)
            file.fail(file.field("values"), fmt::format("it ends within record {}", k));
        const auto from = values.begin() + static_cast<long>(used);
        record.values.assign(from, from + static_cast<long>(size));
        used += size;
        stored.records.push_back(std::move(record));
    }
    const auto finite = [](float value) { return std::isfinite(value); };
    if (used != values.size() || !std::ranges::all_of(values, finite))
        file.fail(file.field("values"), "it holds more than the records, or no numbers");
    if (!std::ranges::all_of(points, finite))
        file.fail(file.field("points"), "it holds no numbers");
    for (std::size_t p = 0; p < points.size(); p += 9) {
        const float* n = points.data() + p;
        stored.points.push_back(
            {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}, {n[6], n[7], n[8]}, sides[p / 9]});
    }
    mapped.checkIntact();
    return stored;
}

}  // namespace hshfit::inline transport::inline radiance_cache
