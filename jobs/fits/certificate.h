#pragma once

#include <brdfs/fit/fit_json.h>
#include <hshfit/files/file_set.h>

#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace hshfit::jobs {

/// A field of a certificate that a laboratory states.
struct CertificateField {
    std::string_view key, label, section;
};
/// The fields of docs/schemas/certificate_fields.schema.json, in the order of the certificate.
std::span<const CertificateField> certificateFields();

/// The fields of a file, {"format": "hshfit-certificate-fields", "version": 1, KEY: TEXT or
/// [LINE, …], …}, by key. Throws InputError for another key and for a value that is no text.
std::map<std::string, std::string> readCertificateFields(const std::string& path);

/// The certificate of a fit, complete but not yet under its name. `fields` is the path of their
/// file, or empty: fields that it does not have are "not stated". `result` is the preset as text.
/// Throws NoFigures where gnuplot is missing.
std::unique_ptr<FileSet> makeCertificate(const brdfs::FitReport& report, const std::string& result,
                                         const std::string& fields, const std::string& path);

}  // namespace hshfit::jobs
