#include "convert.h"

#include <jobs/common/named_errors.h>
#include <jobs/source/picture.h>
#include <jobs/source/source.h>

#include <hshfit/brdf/colour.h>
#include <hshfit/error.h>
#include <hshfit/files/extension.h>
#include <hshfit/files/file_set.h>
#include <hshfit/files/output_rule.h>
#include <hshfit/files/standard_streams.h>
#include <hshfit/pictures/poor.h>
#include <hshfit/spelling.h>
#include <hshfit/wording.h>

#include <brdfs/catalog.h>
#include <brdfs/measured/mueller.h>
#include <brdfs/rows/spec.h>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string_view>
#include <utility>
#include <variant>

namespace hshfit::jobs {
namespace {

/// "merl (.binary), rgl (.bsdf), …"
std::string writableFormats() {
    std::string text;
    for (const auto& writer : brdfs::writers()) {
        text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", writer.name, writer.extension);
    }
    return text;
}

/// The requested writer, else the first in the table that has the file's extension.
const brdfs::Writer& chooseWriter(const std::string& format, const std::string& output) {
    const std::string name = format.substr(0, format.find(':'));
    const std::string extension = extensionOf(output);
    for (const auto& writer : brdfs::writers()) {
        if (name.empty() ? writer.extension == extension : writer.name == name) return writer;
    }
    if (!name.empty()) {
        throw UsageError(fmt::format("{}: unknown format{}; those that can be written are {}",
                                     Setting{"ConvertOptions::format", name},
                                     spelling::question(name, spelling::namesOf(brdfs::writers())),
                                     writableFormats()));
    }
    throw UsageError(
        fmt::format("{}: the formats that can be written are {}; choose by the extension or with "
                    "{}",
                    output, writableFormats(), Setting{"ConvertOptions::format"}));
}

brdfs::Parameters writerParameters(const brdfs::Writer& writer, const std::string& format) {
    const std::size_t colon = format.find(':');
    return brdfs::parseParameters(writer.name, writer.parameters,
                                  colon == std::string::npos ? "" : format.substr(colon + 1));
}

/// Opens the file that was written from `input`; of several blocks, the one of the same side.
std::unique_ptr<Brdf> openWritten(const Brdf& input, const std::string& output,
                                  const brdfs::Parameters& parameters) {
    const auto side = parameters.words.find("side");
    if (side == parameters.words.end() || side->second != "all") return brdfs::open(output);
    for (const auto& [name, value] : input.facts())
        if (name == "side")
            return brdfs::open(fmt::format("{}:side={}", output, std::get<std::string>(value)));
    return brdfs::open(output);
}

/// The file that was written, as RGB where spectra stand for the colours of the input.
std::unique_ptr<Brdf> openComparable(const Brdf& input, const std::string& output,
                                     const brdfs::Parameters& parameters) {
    auto read = openWritten(input, output, parameters);
    const auto isSpectral = [](const Brdf& brdf) {
        return brdf.channels().kind == Channels::Kind::spectral;
    };
    const bool isOneNumber = read->channels().count() == 1 && input.channels().count() == 1;
    if (isSpectral(*read) && !isSpectral(input) && !isOneNumber) return asRgb(std::move(read));
    return read;
}

/// Reads the file back and compares it with the BRDF that it was written from.
ConversionLoss measureLoss(const Brdf& input, const std::string& output,
                           const brdfs::Parameters& parameters, const ConvertOptions& options,
                           const Listener& listener) {
    const auto read = openComparable(input, output, parameters);
    const OutgoingSet outgoing =
        outgoingOrDefault(options.outgoing, input.laws().isotropic ? *read : input);
    return {outgoing.spec(), compare(input, *read, outgoing, selectMetrics("all"),
                                     {.progress = listener.part("loss")})};
}

/// The loss of the file, read back, so that every conversion can state it: relative L2 of f c
/// over few directions with a coarse quadrature, and the picture error. Nothing where the channels
/// differ.
void stateError(const Brdf& input, const std::string& output, const brdfs::Parameters& parameters,
                const Listener& listener, Converted& result) {
    const OutgoingSet outgoing =
        input.laws().isotropic ? OutgoingSet::elevations(6) : OutgoingSet::parabolic(6, 6);
    try {
        const auto read = openComparable(input, output, parameters);
        result.error =
            compare(input, *read, outgoing, selectMetrics("relative-l2-cosine"), {.level = 1})[0]
                .value;
        if (!result.error) return;
        result.errorOver = fmt::format("f cos(theta_i) for {} outgoing {}", outgoing.spec(),
                                       input.laws().isotropic ? "elevations" : "directions");
        result.picture = pictureErrorOf(input, *read);
    } catch (const Error& error) {  // spectra that were written as colours, for one
        result.error = {};
        listener.say(fmt::format("the error of {} is not known: {}", output, error.what()));
    }
    if (!result.error) return;
    const auto reason = poorReason(1 - *result.error * *result.error, result.picture);
    if (reason)
        result.poor = Poor{.reason = fmt::format("{}: {}", output, *reason),
                           .toTry = fmt::format("more nodes, or another format ({})",
                                                Call{.function = "writers"})};
}

/// Writes, and measures what was lost. The counts of repairs are known once all is written.
Converted converted(const Brdf& brdf, const brdfs::RepairedBrdf* repaired,
                    const std::string& output, const brdfs::Writer& writer,
                    const ConvertOptions& options, const Listener& listener) {
    const brdfs::Parameters parameters = writerParameters(writer, options.format);
    Converted result;
    result.input = brdf.name();
    result.written = writer.name;
    result.altered = writer.write(brdf, output, parameters,
                                  {.force = options.force, .progress = listener.part("convert")});
    std::error_code error;  // standard output has no size
    const auto bytes = std::filesystem::file_size(output, error);
    result.bytes = error ? 0 : bytes;
    if (repaired) result.repairs = Repairs{repaired->evaluated(), repaired->counts()};
    if (options.measureLoss) {
        result.loss = measureLoss(brdf, output, parameters, options, listener);
    }
    if (writer.readBack && !isStandardOutput(output))
        stateError(brdf, output, parameters, listener, result);
    brdf.checkIntact();
    return result;
}

/// Converts a specification, which is opened after the format is known to take it.
Converted convertedFrom(const std::string& input, const std::string& output,
                        const brdfs::Writer& writer, const ConvertOptions& options,
                        const Listener& listener) {
    writerParameters(writer, options.format);
    std::unique_ptr<Brdf> brdf = openSource(input, options.rgb, Sides::either);
    if (options.repairs.empty())
        return converted(*brdf, nullptr, output, writer, options, listener);
    const auto repaired =
        brdfs::repaired(std::move(brdf), options.repairs, listener.part("repair"));
    return converted(*repaired, repaired.get(), output, writer, options, listener);
}

/// The writer, once the options are known not to contradict it.
const brdfs::Writer& checkedWriter(const ConvertOptions& options, const std::string& output) {
    const brdfs::Writer& writer = chooseWriter(options.format, output);
    if (options.measureLoss && isStandardOutput(output))
        throw UsageError(fmt::format("{}: standard output is not read back",
                                     Setting{"ConvertOptions::measureLoss"}));
    if (options.measureLoss && !writer.readBack)
        throw UsageError(fmt::format("{}: {} is for other programs to read; nothing here reads it",
                                     Setting{"ConvertOptions::measureLoss"}, writer.name));
    if (!options.outgoing.empty()) OutgoingSet::parse(options.outgoing);
    return writer;
}

}  // namespace

Converted convert(const std::string& input, const std::string& output,
                  const ConvertOptions& options, const Listener& listener) {
    const brdfs::Writer& writer = checkedWriter(options, output);
    Converted result;
    withFileNamed(input, [&] { result = convertedFrom(input, output, writer, options, listener); });
    return result;
}

namespace {

/// Under a rule that refuses, formats of other programs are told by their bytes. Converts the
/// inputs of which a file stands, which throws where bytes differ, before any file is written, and
/// takes them out.
std::vector<std::string> requireEqual(std::vector<std::string>& inputs,
                                      std::vector<std::string>& outputs,
                                      const ConvertOptions& options, const Listener& listener) {
    std::vector<std::string> kept, leftInputs, leftOutputs;
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        std::error_code error;
        bool isKept = false;
        try {
            if (std::filesystem::exists(outputs[i], error)) {
                convert(inputs[i], outputs[i], options, listener);
                isKept = true;
            }
        } catch (const OutputError&) {
            throw;
        } catch (const Error&) {
            // The failure is met again, and reported, when the input is converted with the others.
        }
        (isKept ? kept : leftOutputs).push_back(outputs[i]);
        if (!isKept) leftInputs.push_back(inputs[i]);
    }
    inputs = std::move(leftInputs);
    outputs = std::move(leftOutputs);
    return kept;
}

}  // namespace

Many<Converted> convertMany(const std::vector<std::string>& specs, const std::string& folder,
                            const ConvertOptions& options, const Listener& listener) {
    if (options.format.empty())
        throw UsageError(fmt::format("{}: give the format of many files, of {}",
                                     Setting{"ConvertOptions::format"}, writableFormats()));
    const brdfs::Writer& writer = chooseWriter(options.format, {});
    writerParameters(writer, options.format);
    std::vector<std::string> inputs = expandInputs(specs);
    std::vector<std::string> outputs = outputPaths(inputs, folder, std::string(writer.extension));
    requireFolder(folder);
    FileSet made(folder, options.force);  // the folder, which goes again if it stays empty
    std::vector<std::string> kept;
    if (outputRule().replace)
        for (const std::string& output : outputs)
            made.requireFree(std::filesystem::path(output).filename().string());
    else
        kept = requireEqual(inputs, outputs, options, listener);
    auto many = makeMany<Converted>(
        std::move(inputs), std::move(outputs), "convert", listener,
        [&](const std::string& input, const std::string& output, const Listener& each) {
            return convert(input, output, options, each);
        });
    made.commit();
    std::ranges::move(kept, std::back_inserter(many.kept));
    return many;
}

Converted convertBrdf(const Brdf& brdf, const std::string& output, const ConvertOptions& options,
                      const Listener& listener) {
    if (!options.repairs.empty() || options.rgb)
        throw UsageError(fmt::format("{} and {} are for a specification, not for a BRDF at hand",
                                     Setting{"ConvertOptions::repairs"},
                                     Setting{"ConvertOptions::rgb"}));
    brdfs::requireReflectance(brdf, "convert");
    return converted(brdf, nullptr, output, checkedWriter(options, output), options, listener);
}

}  // namespace hshfit::jobs
