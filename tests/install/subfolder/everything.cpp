#include <hshfit/hshfit.h>
#include <hshfit/light/catalog.h>

const char* versionOfLibrary() {
    return hshfit::version;
}
