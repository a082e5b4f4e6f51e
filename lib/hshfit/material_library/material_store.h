#pragma once

#include <hshfit/files/scratch_file.h>
#include <hshfit/material_library/library.h>

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

namespace hshfit::material_library {

/// Materials on their way into a library, on a disk (scratch_file.h): memory holds their names,
/// some 50 bytes a material. It has the materials that learning takes, and the materials with forms
/// of their own.
///
/// Members throw OutputError where the disk does not take or give the bytes.
class MaterialStore {
public:
    /// `folder` as of ScratchFile.
    explicit MaterialStore(const std::string& folder) : folder_(folder), file_(folder) {}

    /// May be called from any thread, before sort().
    void add(const Measured& measured);
    /// A material with a halfway form.
    void add(const Material& own);

    /// Sorts the materials by name. To be called once, before any member below. Throws UsageError
    /// for two materials of one name.
    void sort();

    /// The number of materials that learning takes. They are numbered from 0.
    std::size_t size() const { return measured_.size(); }
    std::size_t channels(std::size_t measured) const { return measured_[measured].channels; }
    std::size_t ownForms() const { return own_.size(); }
    const std::string& name(std::size_t measured) const { return measured_[measured].name; }
    const std::string& ownName(std::size_t own) const { return own_[own].name; }
    /// From any thread.
    Measured measured(std::size_t number) const;
    Material own(std::size_t number) const;

    const std::string& folder() const { return folder_; }

private:
    struct Place {
        std::string name;
        std::uint64_t offset = 0;
        std::uint32_t bytes = 0, channels = 0;
    };
    void add(std::vector<Place>& places, Place place, const std::string& record);
    std::string recordOf(const Place& place) const;

    std::string folder_;
    ScratchFile file_;
    std::mutex adding_;
    std::vector<Place> measured_, own_;
};

}  // namespace hshfit::material_library
