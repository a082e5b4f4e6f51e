#pragma once

// The shared parts of the two EXR containers, for sources that use OpenEXR.

#include <hshfit/coefficient_files/coefficient_formats.h>
#include <hshfit/error.h>
#include <hshfit/files/printable.h>
#include <hshfit/gpu/containers/containers.h>

#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <fmt/format.h>

namespace hshfit::gpu::inline containers {

inline constexpr std::string_view exrSidecar = "hshfit:sidecar";

/// An RGBA header with ZIP compression; HALF or FLOAT channels. Throws UsageError for integers.
Imf::Header exrHeader(const Texels& texels, int height);
/// The sidecar and the facts as string attributes.
void describeExr(const TexelFile& file, Imf::Header& header);
/// R, G, B, A interleaved from `first` on; OpenEXR does not write to it when it writes a file.
Imf::FrameBuffer exrSlices(const Texels& texels, const std::byte* first);
/// Throws InputError unless the header has the four channels with the number type of `texels`.
void checkExrChannels(const Imf::Header& header, const Texels& texels, const std::string& file);
/// OpenEXR's exceptions as ours.
template <class Work>
auto readingExr(const std::string& file, const Work& work) {
    try {
        return work();
    } catch (const Error&) {
        throw;
    } catch (const std::exception& error) {
        throw InputError(
            fmt::format("{}: invalid OpenEXR data: {}", file, printable(error.what())));
    }
}

/// Throws InputError if there is none.
std::string exrSidecarOf(const Imf::Header& header, const std::string& file);

}  // namespace hshfit::gpu::inline containers
