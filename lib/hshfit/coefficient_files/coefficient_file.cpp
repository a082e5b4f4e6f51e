#include <hshfit/coefficient_files/coefficient_file.h>
#include <hshfit/coefficient_files/coefficient_formats.h>
#include <hshfit/coefficient_files/coefficient_path.h>
#include <hshfit/coefficient_files/representation_file.h>
#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/files/exr_header.h>
#include <hshfit/files/extension.h>
#include <hshfit/files/json_format.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <limits>
#include <system_error>

#include <fmt/format.h>

namespace hshfit::inline coefficient_files {
namespace {

enum class Form { none, json, exr };

Form formByExtension(const std::string& path) {
    const std::string extension = extensionOf(path);
    if (extension == ".json") return Form::json;
    if (extension == ".exr") return Form::exr;
    return Form::none;
}

Form formByContent(std::string_view bytes) {
    if (hasExrMagic(bytes)) return Form::exr;
    return beginsAsJson(bytes) ? Form::json : Form::none;
}

/// Throws UsageError where the extension is of neither.
Form writableForm(const std::string& path) {
    const Form form = formByExtension(path);
    if (form != Form::none) return form;
    throw UsageError(fmt::format(
        "'{}': coefficient files are .json (exact) or .exr (float32); give one of the two", path));
}

bool isPlain(const Representation& representation) {
    const auto* whole = representation.as<CoefficientArray>();
    return representation.added.empty() && representation.steps.empty() && whole &&
           whole->coefficients.precision == Precision::float64;
}

/// Throws UsageError where a file of that extension cannot hold the form.
void checkForm(const Representation& representation, const std::string& path) {
    if (isPlain(representation))
        writableForm(path);
    else if (formByExtension(path) != Form::json) {
        throw UsageError(
            fmt::format("'{}': forms other than plain coefficients are kept in .json files", path));
    }
}

}  // namespace

std::string readRegularFile(const std::string& path, std::size_t limit) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status)) {
        throw InputError(fmt::format("{}: no such file", path));
    }
    if (!std::filesystem::is_regular_file(status)) {
        throw InputError(fmt::format("{}: is not a regular file", path));
    }
    std::ifstream in(path, std::ios::binary);
    if (!in) {
        throw InputError(
            fmt::format("{}: cannot be opened: {}", path, std::generic_category().message(errno)));
    }
    std::string bytes;
    std::string block(std::size_t{1} << 16, '\0');
    while (in && bytes.size() < limit) {
        in.read(block.data(), static_cast<std::streamsize>(block.size()));
        bytes.append(block, 0, static_cast<std::size_t>(in.gcount()));
    }
    if (in.bad()) throw InputError(fmt::format("{}: cannot be read to its end", path));
    return bytes;
}

void requireCoefficientPath(const std::string& path) {
    writableForm(path);
}

void writeCoefficients(const Coefficients& coefficients, const std::string& path) {
    writableForm(path);
    AtomicFile file(path);
    writeCoefficients(coefficients, file);
    file.commit();
}

void writeCoefficients(const Coefficients& coefficients, AtomicFile& file) {
    const Form form = writableForm(file.path());
    assert(coefficients.values.size() ==
           coefficients.outgoing.size() * coefficients.channels.count() * coefficients.slots());
    if (form == Form::json) {
        file.write(coefficientsToJson(coefficients));
    } else {
        coefficientsToExr(coefficients, file);
    }
}

Coefficients readCoefficients(const std::string& path) {
    const std::string bytes = readRegularFile(path, std::numeric_limits<std::size_t>::max());
    if (bytes.empty()) throw InputError(fmt::format("{}: is empty", path));
    Form form = formByContent(bytes);
    if (form == Form::none) form = formByExtension(path);
    switch (form) {
        case Form::json:
            return coefficientsFromJson(bytes, path);
        case Form::exr:
            return coefficientsFromExr(bytes, path);
        case Form::none:
            break;
    }
    throw InputError(
        fmt::format("{}: is not a coefficient file, neither hshfit JSON nor OpenEXR", path));
}

void writeRepresentation(const Representation& representation, const std::string& path) {
    checkForm(representation, path);
    AtomicFile file(path);
    writeRepresentation(representation, file);
    file.commit();
}

void writeRepresentation(const Representation& representation, AtomicFile& file) {
    checkForm(representation, file.path());
    if (isPlain(representation))
        writeCoefficients(decoded(representation), file);
    else
        file.write(representationToJson(representation));
}

Representation readRepresentation(const std::string& path) {
    const std::string bytes = readRegularFile(path, std::numeric_limits<std::size_t>::max());
    if (formByContent(bytes) == Form::json && hasRepresentation(bytes)) {
        return representationFromJson(bytes, path);
    }
    return fromCoefficients(readCoefficients(path));
}

bool looksLikeCoefficients(const std::string& path) {
    try {
        if (!hasExrMagic(readRegularFile(path, std::size_t{1} << 16)))
            return jsonFormatOf(path) == coefficientFormat;
        // The list of channels comes before the attribute that tells.
        return exrSaysCoefficients(readRegularFile(path, std::size_t{1} << 22));
    } catch (const InputError&) {
        return false;
    }
}

}  // namespace hshfit::inline coefficient_files
