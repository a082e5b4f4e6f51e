#pragma once

#include <brdfs/catalog.h>
