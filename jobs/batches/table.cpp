#include "table.h"

#include <jobs/common/inputs.h>
#include <jobs/scenes/spheres.h>
#include "costs.h"
#include "program.h"

#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/files/checksum.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/template_text.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <fstream>
#include <iterator>
#include <map>
#include <set>

namespace hshfit::embedded {
extern const std::string_view batch_html;
extern const std::string_view page_css;
}  // namespace hshfit::embedded

namespace hshfit::jobs {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr std::size_t longestText = 120;

/// Times differ from run to run: they are in times.csv and not in the table.
bool isTime(const std::string& key) {
    return key.ends_with("seconds") || key.ends_with("_ns");
}

/// The scalars of an answer by their path, "energy.value". Elements of an array count if it has one
/// alone, or if they have a name.
void flatten(const Json& value, const std::string& path, Json& row) {
    const std::string prefix = path.empty() ? "" : path + ".";
    if (value.is_object()) {
        for (const auto& [key, each] : value.items())
            if (!isTime(key)) flatten(each, prefix + key, row);
    } else if (value.is_array()) {
        for (const Json& each : value) {
            const bool named =
                each.is_object() && each.contains("name") && each["name"].is_string();
            if (named)
                flatten(each, prefix + each["name"].get<std::string>(), row);
            else if (value.size() == 1)
                flatten(each, path, row);
        }
    } else if (!value.is_string() || value.get_ref<const std::string&>().size() <= longestText) {
        row[path] = value;
    }
}

Json answerOf(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    return text.empty() ? Json(nullptr) : Json::parse(text, nullptr, false);
}

Json rowOf(const ItemStatus& status, const BatchStore& store, const BatchProgram& program) {
    const BatchItem& item = *status.item;
    Json row = {{"name", item.name},
                {"command", std::string(program.commands[item.command].name)},
                {"input", item.inputs.front()},
                {"state", std::string(nameOf(status.state))}};
    if (status.state == ItemStatus::State::missing) return row;
    row["exit_code"] = status.record->exitCode;
    if (!status.record->message.empty()) row["message"] = status.record->message;
    const Json answer = answerOf(store.place(item.name) / "answer.json");
    if (answer.is_object()) {
        Json found;
        flatten(answer, "", found);
        for (const auto& [key, value] : found.items())
            if (!row.contains(key) && key != "format" && key != "version") row[key] = value;
    }
    return row;
}

std::string csvCell(const Json& value) {
    if (value.is_null()) return "";
    std::string text = value.is_string() ? value.get<std::string>() : jsonText(value);
    if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

/// Every key of the rows, in the order in which they come first.
std::vector<std::string> columnsOf(const std::vector<Json>& rows) {
    std::vector<std::string> columns;
    std::set<std::string, std::less<>> seen;
    for (const Json& row : rows)
        for (const auto& [key, value] : row.items())
            if (seen.insert(key).second) columns.push_back(key);
    return columns;
}

void writeCsv(AtomicFile& file, const std::vector<Json>& rows,
              const std::vector<std::string>& columns) {
    std::string line;
    for (const std::string& column : columns) {
        if (!line.empty()) line += ',';
        line += csvCell(column);
    }
    file.write(line + "\n");
    for (const Json& row : rows) {
        line.clear();
        for (std::size_t i = 0; i < columns.size(); ++i) {
            if (i > 0) line += ',';
            if (row.contains(columns[i])) line += csvCell(row[columns[i]]);
        }
        file.write(line + "\n");
    }
}

void writeTimes(AtomicFile& file, const std::vector<ItemStatus>& items,
                const BatchProgram& program) {
    file.write("name,class,wider_class,seconds,cpu_seconds,peak_bytes\n");
    for (const ItemStatus& status : items)
        if (status.record && status.record->isDone())
            file.write(fmt::format("{},{},{},{:.6g},{:.6g},{}\n", status.item->name,
                                   classOf(*status.item, program),
                                   widerClassOf(*status.item, program), status.record->seconds,
                                   status.record->cpuSeconds, status.record->peakBytes));
}

/// The picture of a material, named by what it is, and the same for all items of it.
std::string thumbnailName(const ItemStatus& status, int pixels) {
    std::string facts = fmt::format("{} {}", status.item->inputs.front(), pixels);
    if (status.record)
        for (const InputStamp& input : status.record->inputs) facts += " " + input.sha256;
    constexpr std::size_t digits = 20;
    return sha256(facts).substr(0, digits) + ".png";
}

/// Draws spheres of the materials of finished items in the folder `thumbnails`; pictures that are
/// there stay. A material that cannot be shown has none.
std::map<std::string, std::string> drawThumbnails(const std::vector<ItemStatus>& items,
                                                  const fs::path& folder, int pixels,
                                                  const Listener& listener) {
    std::map<std::string, std::string> inputs, shown;  // by the picture's name
    for (const ItemStatus& status : items)
        if (status.state == ItemStatus::State::done)
            inputs.emplace(thumbnailName(status, pixels), status.item->inputs.front());
    std::error_code error;
    fs::create_directories(folder / "thumbnails", error);
    if (error) throw OutputError(folder.string() + "/thumbnails: " + error.message());
    std::vector<std::string> names, specs;
    for (const auto& [name, spec] : inputs) {
        if (fs::exists(folder / "thumbnails" / name, error)) continue;
        names.push_back(name);
        specs.push_back(spec);
    }
    constexpr int samplesAlong = 2;
    forEachInput(specs, listener, "thumbnails", [&](std::size_t i, ProgressCall) {
        SphereSheetOptions options;
        options.size = pixels;
        options.samples = samplesAlong;
        render({specs[i]}, (folder / "thumbnails" / names[i]).string(), options);
    });
    for (const auto& [name, spec] : inputs)
        if (fs::exists(folder / "thumbnails" / name, error)) shown[name] = spec;
    return shown;
}

/// JSON that can stand within a script element.
std::string scriptText(const Json& value) {
    std::string text = jsonText(value);
    for (std::size_t at = 0; (at = text.find("</", at)) != std::string::npos; at += 3)
        text.replace(at, 2, "<\\/");
    return text;
}

std::string pageText(const std::vector<ItemStatus>& items, std::vector<Json> rows,
                     const std::vector<std::string>& columns, const fs::path& folder,
                     const MergeOptions& options, const Listener& listener) {
    if (options.thumbnail > 0) {
        const auto shown = drawThumbnails(items, folder, options.thumbnail, listener);
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const std::string name = thumbnailName(items[i], options.thumbnail);
            if (shown.contains(name)) rows[i]["thumbnail"] = name;
        }
    }
    kainjow::mustache::data fields;
    fields.set("css", std::string(embedded::page_css));
    fields.set("rows", scriptText(rows));
    fields.set("columns", scriptText(columns));
    fields.set("pixels", std::to_string(options.thumbnail));
    return filledPage(embedded::batch_html, fields);
}

}  // namespace

std::string_view nameOf(ItemStatus::State state) {
    constexpr std::array<std::string_view, 4> names{"done", "failed", "stale", "missing"};
    return names[static_cast<std::size_t>(state)];
}

std::vector<ItemStatus> statusOf(const Manifest& manifest, const std::string& folder,
                                 const BatchProgram& program, const Listener& listener) {
    const BatchStore store(folder);
    FileSums sums;
    std::vector<ItemStatus> items(manifest.items.size());
    const ProgressCall progress = listener.part("reading records");
    std::atomic<std::size_t> read = 0;
    tbb::parallel_for(std::size_t{0}, items.size(), [&](std::size_t i) {
        ItemStatus& status = items[i];
        status.item = &manifest.items[i];
        status.record = store.read(status.item->name);
        if (status.record) {
            using State = ItemStatus::State;
            bool valid = false;
            try {
                valid =
                    stateOf(*status.item, program, sums, status.record).key == status.record->key &&
                    store.isWhole(*status.record);
            } catch (const InputError&) {
                valid = false;
            }
            const bool failed = !status.record->isDone();
            status.state = failed ? State::failed : valid ? State::done : State::stale;
        }
        if (progress) progress(++read, items.size());
    });
    std::ranges::sort(items, {}, [](const ItemStatus& status) { return status.item->name; });
    return items;
}

std::vector<std::string> mergeBatch(const std::vector<ItemStatus>& items, const std::string& folder,
                                    const BatchProgram& program, const MergeOptions& options,
                                    const Listener& listener) {
    const BatchStore store(folder);
    std::vector<Json> rows(items.size());
    tbb::parallel_for(std::size_t{0}, items.size(),
                      [&](std::size_t i) { rows[i] = rowOf(items[i], store, program); });
    const std::vector<std::string> columns = columnsOf(rows);
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) throw OutputError(fmt::format("{}: {}", folder, error.message()));
    std::vector<std::string> paths;
    const auto write = [&](const char* name, const std::function<void(AtomicFile&)>& fill) {
        paths.push_back((fs::path(folder) / name).string());
        AtomicFile file(paths.back());
        fill(file);
        file.commit();
    };
    write("table.csv", [&](AtomicFile& file) { writeCsv(file, rows, columns); });
    write("table.jsonl", [&](AtomicFile& file) {
        for (const Json& row : rows) file.write(jsonText(row) + "\n");
    });
    write("times.csv", [&](AtomicFile& file) { writeTimes(file, items, program); });
    write("index.html", [&](AtomicFile& file) {
        file.write(pageText(items, rows, columns, folder, options, listener));
    });
    return paths;
}

}  // namespace hshfit::jobs
