#include <hshfit/material_library/library_writer.h>

#include <hshfit/files/json_fields.h>
#include <hshfit/files/tensor_file_writer.h>
#include <hshfit/material_library/internal/library_format.h>
#include <hshfit/material_library/internal/log_samples.h>
#include <hshfit/material_library/library_file.h>
#include <hshfit/material_library/log_terms.h>
#include <hshfit/version.h>

#include <Imath/half.h>
#include <fmt/format.h>

#include <span>
#include <vector>

namespace hshfit::material_library {
namespace {

using OrderedJson = nlohmann::ordered_json;
using Type = TensorFile::Type;

OrderedJson errorJson(const FormError& error) {
    return {{"mean_log", error.meanLog},       {"log", error.logError},
            {"relative_l2", error.relativeL2}, {"maximum", error.maximum},
            {"largest", error.largest},        {"flip", error.flip}};
}

OrderedJson rowOf(const Material& m) {
    OrderedJson row = {{"name", m.name},         {"source", m.source},
                       {"kind", nameOf(m.kind)}, {"channels", m.channels},
                       {"bytes", m.bytes},       {"error", errorJson(m.error)}};
    if (m.kind == Kind::halfway) row["length"] = m.halfway.size();
    if (!m.fallback.empty()) row["fallback"] = m.fallback;
    return row;
}

OrderedJson rowOf(const Measured& m) {
    return {{"name", m.name},
            {"source", m.source},
            {"channels", m.channels()},
            {"error", errorJson(m.error)}};
}

/// The fields of the head around the rows.
OrderedJson headOf(const Library& library) {
    return {{"format", libraryFormat},
            {"version", library.basis.scaled ? newestLibrary : versionWithoutScales},
            {"generator", fmt::format("hshfit {}", version)},
            {"terms", logTerms().size()},
            {"step", library.basis.step},
            {"limit",
             {{"log", library.limits.log},
              {"maximum", library.limits.maximum},
              {"flip", library.limits.flip}}},
            {"unseen", {{"log", library.unseen}, {"flip", library.unseenFlip}}},
            {"asked",
             {{"components", library.asked.components},
              {"bytes", library.asked.bytes},
              {"held_out", library.asked.heldOut}}}};
}

/// A row after those before it, of an array of JSON on one line.
void appendRow(ScratchFile& rows, const OrderedJson& row) {
    if (rows.size() > 0) rows.append(",");
    rows.append(jsonText(row));
}

/// The sizes of the arrays of measured materials, and their rows.
struct KeptRows {
    KeptRows(const MeasuredList& measured, const std::string& folder) : rows(folder) {
        for (std::size_t k = 0; k < measured.count; ++k) {
            const Measured one = measured.at(k);
            appendRow(rows, rowOf(one));
            channels += one.channels();
            rests += one.rest.size();
        }
    }

    ScratchFile rows;
    std::uint64_t channels = 0, rests = 0;
};

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

/// Puts one array of each measured material after those before it.
auto putting(const MeasuredList& measured, std::vector<float> Measured::*array) {
    return [&measured, array](AtomicFile& file) {
        for (std::size_t k = 0; k < measured.count; ++k) {
            const Measured one = measured.at(k);
            file.write(std::as_bytes(std::span(one.*array)));
        }
    };
}

auto copying(const ScratchFile& from) {
    return [&from](AtomicFile& file) { from.copyTo(file); };
}

}  // namespace

LibraryWriter::LibraryWriter(const std::string& folder)
    : rows_(folder),
      codes_(folder),
      halfway_(folder),
      polynomials_(folder),
      polynomialTops_(folder),
      folder_(folder) {}

void LibraryWriter::add(const Material& material) {
    appendRow(rows_, rowOf(material));
    codes_.append(std::as_bytes(std::span(material.codes)));
    halfway_.append(material.halfway);
    if (material.kind != Kind::polynomial) return;
    const std::vector<float> exponents = asFloats(material.polynomial.exponents),
                             tops = asFloats(material.polynomial.tops);
    polynomials_.append(std::as_bytes(std::span(exponents)));
    polynomialTops_.append(std::as_bytes(std::span(tops)));
}

void LibraryWriter::write(const Library& library, const MeasuredList& measured,
                          AtomicFile& file) const {
    const std::uint64_t terms = logTerms().size();
    const KeptRows kept(measured, folder_);
    ScratchFile head(folder_);
    std::string begin = jsonText(headOf(library));
    begin.pop_back();  // the brace
    head.append(begin + ",\"materials\":[");
    rows_.copyTo(head);
    head.append("]");
    if (!library.basisFile.empty())
        head.append(",\"basis\":" + jsonText(OrderedJson{{"file", library.basisFile},
                                                         {"sha256", library.basisSum}}));
    if (measured.count > 0) {
        head.append(",\"measured\":[");
        kept.rows.copyTo(head);
        head.append("]");
    }
    head.append("}");

    const std::vector<float> mean = asFloats(library.basis.mean);
    const std::vector<std::uint16_t> components = asHalves(library.basis.components);
    const std::string widths(library.basis.widths.begin(), library.basis.widths.end());
    TensorFileWriter writer;
    writer.add(headField, Type::u8, {head.size()}, copying(head));
    if (library.basisFile.empty() && !library.basis.mean.empty()) {
        writer.add("mean", {terms}, mean);
        writer.add("components", Type::f16, {library.basis.size(), terms},
                   std::as_bytes(std::span(components)));
        writer.add("widths", widths);
    }
    const auto octets = [&](const char* name, const ScratchFile& from) {
        if (from.size() > 0) writer.add(name, Type::u8, {from.size()}, copying(from));
    };
    octets("codes", codes_);
    octets("halfway", halfway_);
    if (const std::uint64_t channels = polynomialTops_.size() / sizeof(float); channels > 0) {
        writer.add("polynomials", Type::f32, {channels, terms}, copying(polynomials_));
        writer.add("polynomial_tops", Type::f32, {channels}, copying(polynomialTops_));
    }
    if (kept.channels > 0) {
        writer.add("exponents", Type::f32, {kept.channels, terms},
                   putting(measured, &Measured::exponents));
        writer.add("tops", Type::f32, {kept.channels}, putting(measured, &Measured::tops));
        // The rests are not known for files that do not state them.
        if (kept.rests == measured.count * restRows)
            writer.add("rests", Type::f32, {measured.count, restRows},
                       putting(measured, &Measured::rest));
    }
    writer.write(file);
}

void writeLibrary(const Library& library, AtomicFile& file) {
    LibraryWriter writer(scratchFolder(file.path()));
    for (const Material& material : library.materials) writer.add(material);
    writer.write(library,
                 {library.measured.size(), [&](std::size_t k) { return library.measured[k]; }},
                 file);
}

}  // namespace hshfit::material_library
