#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/coefficients/outgoing.h>
#include <hshfit/representation/representation.h>

#include <memory>
#include <string>

namespace hshfit::jobs {

/// A BRDF specification (docs/brdfs.md). With `rgb`, a spectral one as linear Rec. 709; others stay
/// as they are.
std::unique_ptr<Brdf> openBrdf(const std::string& spec, bool rgb = false);

/// A BRDF specification, a coefficient file, or a file of an export (a sidecar or a container that
/// holds one), as a BRDF; `rgb` likewise.
std::unique_ptr<Brdf> openSource(const std::string& spec, bool rgb = false);

/// `openSource` for what representations add.
BrdfOpener sourceOpener();

/// Throws what `brdf` has found wrong with its data while it was evaluated; of measured files that
/// hold invalid values only that they could not be read.
void requireReadable(const Brdf& brdf);

/// The set that `text` names (OutgoingSet::parse); if it is empty, 16 elevations for an isotropic
/// BRDF and a 16x16 map otherwise.
OutgoingSet outgoingOrDefault(const std::string& text, const Brdf& brdf);

}  // namespace hshfit::jobs
