#include "certificate.h"

#include <jobs/common/named_files.h>
#include "figures.h"
#include "fit_tables.h"

#include <brdfs/fit/instrument/instrument_text.h>
#include <brdfs/fit/prediction.h>
#include <brdfs/fit/printed_number.h>
#include <brdfs/fit/stated_error.h>
#include <hshfit/error.h>
#include <hshfit/files/checksum.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/pages/page_figures.h>
#include <hshfit/pages/print_document.h>
#include <hshfit/version.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <vector>

namespace hshfit::jobs {
namespace {

namespace fs = std::filesystem;

using Json = nlohmann::ordered_json;
using Fields = std::map<std::string, std::string>;
using Kind = DocumentBlock::Kind;

constexpr std::string_view fieldsFormat = "hshfit-certificate-fields";
constexpr const char* notStated = "not stated";

constexpr CertificateField fieldRows[] = {
    {"certificate", "certificate", "head"},
    {"laboratory", "laboratory", "head"},
    {"date", "date of measurement", "head"},
    {"client", "client", "Client and sample"},
    {"sample", "sample", "Client and sample"},
    {"instrument", "instrument", "Instrument and geometry"},
    {"geometry", "geometry", "Instrument and geometry"},
    {"standard", "standard", "Standard and traceability"},
    {"traceability", "traceability", "Standard and traceability"},
    {"conditions", "ambient conditions", "Conditions"},
    {"method", "procedure", "Method"},
    {"remarks", "remarks", "Remarks"},
    {"operator", "measured by", "Signatures"},
    {"approved_by", "approved by", "Signatures"},
};

std::string valueOf(const JsonFields& fields, const char* key) {
    const auto& value = fields.at(key);
    if (value.is_string()) return fields.word(key);
    return fmt::format("{}", fmt::join(fields.words(key), "\n"));
}

/// A pair of directions and its readings: repeated scans have several.
struct ReadPair {
    DirectionPair directions;
    std::vector<std::size_t> samples;

    double mean(const brdfs::FitSamples& of, std::size_t channel) const {
        double sum = 0;
        for (const std::size_t k : samples) sum += of.value(channel, k);
        return sum / static_cast<double>(samples.size());
    }
    /// The number of its scans; of its readings where samples have no scans.
    std::size_t scans(const brdfs::FitSamples& of) const {
        if (of.scans.empty()) return samples.size();
        std::set<std::size_t> different;
        for (const std::size_t k : samples) different.insert(of.scans[k]);
        return different.size();
    }
};

/// In the order of the first readings.
std::vector<ReadPair> readPairs(const brdfs::FitSamples& samples) {
    std::vector<ReadPair> pairs;
    std::map<std::array<double, 6>, std::size_t> found;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const DirectionPair own{{samples.wiX[k], samples.wiY[k], samples.wiZ[k]}, samples.wo[k]};
        const auto [at, first] = found.try_emplace(
            {own.wi.x, own.wi.y, own.wi.z, own.wo.x, own.wo.y, own.wo.z}, pairs.size());
        if (first) pairs.push_back({own, {}});
        pairs[at->second].samples.push_back(k);
    }
    return pairs;
}

/// Numbers of the pairs with results: all of a few, else evenly spaced ones.
std::vector<std::size_t> shownPairs(std::size_t count) {
    constexpr std::size_t most = 60;
    std::vector<std::size_t> shown;
    const std::size_t rows = std::min(count, most);
    for (std::size_t i = 0; i < rows; ++i)
        shown.push_back(rows < 2 ? 0 : i * (count - 1) / (rows - 1));
    return shown;
}

std::string angle(double radiansValue) {
    // Negative zeros and rounding would else show.
    const double value = std::round(1e3 * degrees(radiansValue)) / 1e3;
    return brdfs::plainValue(value == 0 ? 0 : value, 5);
}

std::string rangeText(std::vector<double> values, std::string_view unit) {
    std::ranges::sort(values);
    const std::string low = brdfs::plainValue(values.front(), 4),
                      high = brdfs::plainValue(values.back(), 4);
    return low == high ? fmt::format("{}{}", low, unit)
                       : fmt::format("{} to {}{}", low, high, unit);
}

class Certificate {
public:
    Certificate(const brdfs::FitReport& report, const std::string& result, Fields fields,
                std::string fieldsPath)
        : report_(report),
          samples_(*report.samples),
          pairs_(readPairs(samples_)),
          resultText_(result),
          preset_(Json::parse(result)),
          fit_(preset_["fit"]),
          fields_(std::move(fields)),
          fieldsPath_(std::move(fieldsPath)) {}

    PrintDocument document() {
        add({.kind = Kind::title, .text = "Certificate of bidirectional reflectance"});
        addPairs(stated("head"));
        addSection("Client and sample", {});
        addSection("Instrument and geometry", geometry());
        addSection("Standard and traceability", {});
        addSection("Conditions", {});
        addSection("Method", method());
        addResults();
        addBudget();
        addFigures();
        addRemarks();
        addSection("Signatures", {});
        addHashes();
        const auto number = fields_.find("certificate");
        return {.footer = fmt::format("{} · hshfit {}",
                                      number == fields_.end() ? "certificate without number"
                                                              : "certificate " + number->second,
                                      version),
                .blocks = std::move(blocks_)};
    }

private:
    void add(DocumentBlock block) { blocks_.push_back(std::move(block)); }
    void addPairs(NamedTexts pairs) { add({.kind = Kind::pairs, .pairs = std::move(pairs)}); }
    void addHeading(std::string_view text) {
        add({.kind = Kind::heading, .text = std::string(text)});
    }
    void addText(std::string text) { add({.kind = Kind::text, .text = std::move(text)}); }
    void addTable(TextTable table, std::string columns) {
        add({.kind = Kind::table,
             .columns = std::move(columns),
             .heads = std::move(table.heads),
             .rows = std::move(table.rows)});
    }

    /// The fields of a section; those that the file does not have are named as such.
    NamedTexts stated(std::string_view section) const {
        NamedTexts pairs;
        for (const CertificateField& row : fieldRows) {
            if (row.section != section) continue;
            const auto own = fields_.find(std::string(row.key));
            pairs.emplace_back(row.label, own == fields_.end() ? notStated : own->second);
        }
        return pairs;
    }
    void addSection(std::string_view section, NamedTexts measured) {
        addHeading(section);
        NamedTexts pairs = stated(section);
        pairs.insert(pairs.end(), measured.begin(), measured.end());
        addPairs(std::move(pairs));
    }

    NamedTexts geometry() const {
        std::vector<double> incidence, detection;
        for (std::size_t k = 0; k < samples_.size(); ++k) {
            incidence.push_back(degrees(polarAngle(incoming(k))));
            detection.push_back(degrees(polarAngle(samples_.wo[k])));
        }
        NamedTexts pairs{{"incidence θi", rangeText(incidence, "°")},
                         {"detection θo", rangeText(detection, "°")},
                         {"pairs of directions", fmt::format("{}", pairs_.size())}};
        if (repeated()) pairs.emplace_back("readings", fmt::format("{}", samples_.size()));
        const Channels& channels = samples_.channels;
        if (channels.kind == Channels::Kind::spectral)
            pairs.emplace_back("wavelengths", fmt::format("{}, {}", channels.count(),
                                                          rangeText(channels.wavelengths, " nm")));
        else
            pairs.emplace_back("channels",
                               channels.count() == 1
                                   ? std::string("one, without a wavelength")
                                   : fmt::format("{}", fmt::join(channels.names(), ", ")));
        if (report_.result.instrument)
            for (auto& row : brdfs::instrumentRows(*report_.result.instrument))
                pairs.push_back(std::move(row));
        return pairs;
    }

    NamedTexts method() const {
        NamedTexts pairs = fitFacts(report_, fit_);
        pairs.insert(pairs.begin(), {"software", fmt::format("hshfit {}", version)});
        return pairs;
    }

    bool repeated() const { return pairs_.size() < samples_.size(); }
    Direction incoming(std::size_t k) const {
        return {samples_.wiX[k], samples_.wiY[k], samples_.wiZ[k]};
    }

    void addResults() {
        addHeading("Results");
        addText("Parameters of the model. " + parameterLegend(report_));
        addTable(parameterTable(report_, fit_, false), "llrrrrrl");
        for (const std::string& set : notToldApart(report_.result))
            addText(fmt::format("The data do not tell apart: {}.", set));
        addValues();
    }

    /// f, measured and fitted, and the radiance factor at pairs of directions.
    void addValues() {
        const std::vector<std::size_t> shown = shownPairs(pairs_.size());
        const std::vector<std::size_t> channels = drawnChannels(samples_.channels);
        const bool certain = !report_.result.point.channels.empty();
        std::vector<DirectionPair> pairs;
        for (const std::size_t p : shown) pairs.push_back(pairs_[p].directions);
        std::optional<brdfs::Prediction> prediction;
        if (certain) prediction = brdfs::predict(report_.result, pairs, false);
        const auto fitted = brdfs::openFit(report_.result);
        const bool several = samples_.channels.count() > 1;
        const std::vector<std::string> names = samples_.channels.names();
        TextTable table{.heads = {"θi", "φi", "θo", "φo"}, .rows = {}};
        if (repeated()) table.heads.emplace_back(samples_.scans.empty() ? "readings" : "scans");
        if (several) table.heads.emplace_back("channel");
        for (const char* head :
             {"f measured, 1/sr", "f, 1/sr", "U(f), 1/sr", "β = π f", "U(β)", "k"})
            table.heads.emplace_back(head);
        for (std::size_t i = 0; i < shown.size(); ++i) {
            const std::vector<double> f = evaluate(*fitted, pairs[i].wi, pairs[i].wo);
            for (const std::size_t c : channels) {
                std::vector<std::string> cells{
                    angle(polarAngle(pairs[i].wi)), angle(azimuth(pairs[i].wi)),
                    angle(polarAngle(pairs[i].wo)), angle(azimuth(pairs[i].wo))};
                const ReadPair& read = pairs_[shown[i]];
                if (repeated()) cells.push_back(fmt::format("{}", read.scans(samples_)));
                if (several) cells.push_back(names[c]);
                const double value = f[f.size() == 1 ? 0 : c];
                const double beta = std::numbers::pi * value;
                cells.push_back(brdfs::plainValue(read.mean(samples_, c), 5));
                if (prediction) {
                    const std::size_t v = c * prediction->pairs + i;
                    const double k = brdfs::coverageFactor(prediction->degrees[v]),
                                 u = prediction->errors[v];
                    cells.insert(
                        cells.end(),
                        {brdfs::plainNumber(value, u), brdfs::plainError(k * u),
                         brdfs::plainNumber(beta, std::numbers::pi * u),
                         brdfs::plainError(std::numbers::pi * k * u), fmt::format("{:.2f}", k)});
                } else {
                    cells.insert(cells.end(), {brdfs::plainValue(value, 5), "–",
                                               brdfs::plainValue(beta, 5), "–", "–"});
                }
                table.rows.push_back(std::move(cells));
            }
        }
        addText(valuesLegend(shown.size(), channels.size(), certain));
        addTable(std::move(table),
                 fmt::format("rrrr{}{}rrrrrr", repeated() ? "r" : "", several ? "l" : ""));
    }

    std::string valuesLegend(std::size_t rows, std::size_t channels, bool certain) const {
        std::string text = fmt::format(
            "BRDF f and radiance factor β = π f at {} of {} pairs of directions{}; angles in "
            "degrees, from the normal and about it. f and β are those of the model; their standard "
            "uncertainties stand in units of the last digits, and U = k u holds them with {:.4g} "
            "%.",
            rows, pairs_.size(),
            channels < samples_.channels.count()
                ? fmt::format(", {} of {} channels", channels, samples_.channels.count())
                : std::string(),
            100 * brdfs::Budget::probability);
        if (repeated())
            text += " Measured values of repeated scans are the mean of their readings.";
        if (!certain)
            text +=
                " With these terms of the instrument no uncertainty of f is calculated; those "
                "of the parameters hold.";
        return text;
    }

    void addBudget() {
        TextTable table = budgetTable(report_.result);
        if (table.rows.empty()) {
            addHeading("Budget of uncertainty");
            addText(
                "No contributions are stated beside the scatter of the samples: uncertainties "
                "above hold no part that all samples share, such as that of the standard.");
            return;
        }
        addHeading("Budget of uncertainty");
        addTable(std::move(table), "llllrrrrr");
    }

    void addFigures() {
        addHeading("Figures");
        addText(
            "Markers: measured values, with bars of one standard uncertainty where it was "
            "stated; lines: the model, the band holds it with 95 %. Standardised residuals, "
            "correlations of the parameters, leverage and Cook’s distances follow where the "
            "fit has them.");
        add({.kind = Kind::figure, .figures = pageFigures(report_, {.width = documentWidth})});
    }

    void addRemarks() {
        addHeading("Remarks");
        NamedTexts pairs = stated("Remarks");
        if (!report_.result.converged)
            pairs.emplace_back("convergence", "not reached: " + report_.result.message);
        if (const std::string outliers = outlierText(fit_); !outliers.empty())
            pairs.emplace_back("outliers", outliers);
        pairs.emplace_back("validity",
                           "Uncertainties of f are those of the fitted curve; they do not hold "
                           "the misfit of a wrong model, of which chi-square tells.");
        addPairs(std::move(pairs));
    }

    void addHashes() {
        addHeading("Hashes (SHA-256)");
        std::set<std::string> files;
        addNamedFiles(report_.data, files);
        for (const std::string& file : files)
            addHash("data " + fs::path(file).filename().string(), fileContent(file));
        addHash("samples that were fitted", sampleText());
        if (!fieldsPath_.empty()) addHash("fields of this certificate", fileContent(fieldsPath_));
        // Without the closing brace, before which a file states its own hash (files/made_from.h).
        addHash("result: content of FIT.json", resultText_.substr(0, resultText_.rfind("\n}")));
    }
    void addHash(std::string name, const std::string& bytes) {
        add({.kind = Kind::text, .text = std::move(name)});
        add({.kind = Kind::code, .text = sha256(bytes)});
    }

    /// A line for each sample: the directions, then a value for each channel.
    std::string sampleText() const {
        std::string text;
        for (std::size_t k = 0; k < samples_.size(); ++k) {
            const Direction &wi = incoming(k), &wo = samples_.wo[k];
            text += fmt::format("{},{},{},{},{},{}", wi.x, wi.y, wi.z, wo.x, wo.y, wo.z);
            for (std::size_t c = 0; c < samples_.channels.count(); ++c)
                text += fmt::format(",{}", samples_.value(c, k));
            text += '\n';
        }
        return text;
    }

    const brdfs::FitReport& report_;
    const brdfs::FitSamples& samples_;
    const std::vector<ReadPair> pairs_;
    const std::string& resultText_;
    Json preset_;
    const Json& fit_;
    Fields fields_;
    std::string fieldsPath_;
    std::vector<DocumentBlock> blocks_;
};

}  // namespace

std::span<const CertificateField> certificateFields() {
    return fieldRows;
}

std::map<std::string, std::string> readCertificateFields(const std::string& path) {
    constexpr int deepest = 4;
    const MappedFile file(path);
    const nlohmann::json document =
        parseJson({reinterpret_cast<const char*>(file.data()), file.size()}, path, deepest);
    file.checkIntact();
    const JsonFields fields(document, "", path);
    if (fields.word("format") != fieldsFormat)
        fields.fail(fmt::format("is not '{}'", fieldsFormat), "format");
    fields.integer("version", 1, 1);
    std::map<std::string, std::string> found;
    for (const auto& [key, value] : document.items()) {
        if (key == "format" || key == "version") continue;
        const auto row = std::ranges::find(fieldRows, key, &CertificateField::key);
        if (row == std::end(fieldRows)) {
            std::vector<std::string_view> known;
            for (const CertificateField& own : fieldRows) known.push_back(own.key);
            throw InputError(fmt::format("{}: unknown field '{}'; known: {}", path, key,
                                         fmt::join(known, ", ")));
        }
        found[key] = valueOf(fields, key.c_str());
    }
    return found;
}

std::unique_ptr<FileSet> makeCertificate(const brdfs::FitReport& report, const std::string& result,
                                         const std::string& fields, const std::string& path) {
    const fs::path file(path);
    auto set = std::make_unique<FileSet>(file.has_parent_path() ? file.parent_path() : ".", true,
                                         FileSet::Above::require);
    Certificate certificate(report, result,
                            fields.empty() ? Fields() : readCertificateFields(fields), fields);
    addDocument(certificate.document(), file.filename().string(), *set);
    return set;
}

}  // namespace hshfit::jobs
