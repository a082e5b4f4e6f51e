#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/coefficients/outgoing.h>
#include <hshfit/representation/representation.h>

#include <memory>
#include <string>

namespace hshfit::jobs {

/// The kinds of scattering that a job takes. Transmissions have laws of their own
/// (hshfit/brdf/transmission.h), and channels that are no reflectance, such as elements of Mueller
/// matrices, have none, so that a job has to ask for them.
enum class Sides { reflection, either, eitherAndNamed };

/// Opens a BRDF specification (docs/reference/brdfs.md) or a texel of a material map
/// (FILE:x=3,y=5,level=0). `rgb` converts a spectral BRDF to linear Rec. 709 and leaves others
/// unchanged. Throws UsageError for a transmission, and InputError for channels that are no
/// reflectance, unless `sides` says otherwise.
std::unique_ptr<Brdf> openBrdf(const std::string& spec, bool rgb = false,
                               Sides sides = Sides::reflection);

/// Opens what openBrdf does, a coefficient file or a file of an export (a sidecar or a container
/// with one) as a BRDF; `rgb` as above.
std::unique_ptr<Brdf> openSource(const std::string& spec, bool rgb = false,
                                 Sides sides = Sides::reflection);

/// openBrdf in linear Rec. 709 for a comparison with `source`: a grey BRDF beside colours has three
/// equal channels.
std::unique_ptr<Brdf> openBeside(const std::string& spec, const Brdf& source);

/// `openSource` as the opener of BRDFs that representations add.
BrdfOpener sourceOpener();

/// Throws the data error that `brdf` recorded during evaluation. Invalid stored values of a
/// measured file are no error here; a failed read is.
void requireReadable(const Brdf& brdf);

/// Says that f is 0 because all stored values of a measured BRDF are below 0; else empty. Reads
/// them all.
std::string whyZero(const Brdf& brdf);

/// The set that `text` names (OutgoingSet::parse); if it is empty, 16 elevations for an isotropic
/// BRDF and a 16x16 map otherwise.
OutgoingSet outgoingOrDefault(const std::string& text, const Brdf& brdf);

}  // namespace hshfit::jobs
