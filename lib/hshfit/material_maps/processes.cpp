#include <hshfit/material_maps/processes.h>

namespace hshfit::inline material_maps {

ItemRange Processes::share(std::size_t items) const {
    return {items * number() / count(), items * (number() + 1) / count()};
}

void Processes::gather(std::size_t, std::size_t, void*) {}

std::unique_ptr<BandDealer> Processes::deal(std::size_t bands) {
    return std::make_unique<OneDealer>(bands);
}

}  // namespace hshfit::inline material_maps
