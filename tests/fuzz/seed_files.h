#pragma once

#include <filesystem>
#include <string>

/// A seed's bytes; its folder is made.
void writeSeed(const std::filesystem::path& path, const std::string& bytes);

/// Seeds of every format of meshes.
void meshSeeds(const std::filesystem::path& folder);
