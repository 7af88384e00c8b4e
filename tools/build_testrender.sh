#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds oslc, testrender and testshade of Open Shading Language on Debian 12, in about 20 minutes on
# two cores, and prints the environment variables with which mxeon finds the programs.
#
#   build_testrender.sh FOLDER
#
# Debian packages: git python3-pip flex bison cmake ninja-build g++ clang-14 libclang-14-dev llvm-14-dev
# libimath-dev libpugixml-dev libfmt-dev zlib1g-dev
#
# Debian 12's OpenImageIO is too old. The libraries of a newer version come from the PyPI wheel, and
# the headers come from the sources. The script writes the version header and the CMake package.
set -eu
folder=${1:?usage: build_testrender.sh FOLDER}
jobs=${JOBS:-$(nproc)}
osl=v1.15.6.0 oiio=3.1.16.0 robin=v1.4.1
mkdir -p "$folder"
cd "$folder"
folder=$PWD

sources() { # FOLDER TAG URL
    # Rename the clone only when complete, because an interrupted clone leaves a folder.
    [ -d "$1" ] && return
    rm -rf "$1.part"
    git -c advice.detachedHead=false clone --quiet --depth 1 --branch "$2" "$3" "$1.part"
    mv "$1.part" "$1"
}
sources osl "$osl" https://github.com/AcademySoftwareFoundation/OpenShadingLanguage
sources oiio "v$oiio" https://github.com/AcademySoftwareFoundation/OpenImageIO
sources robin "$robin" https://github.com/Tessil/robin-map

prefix=$folder/prefix
if [ ! -d "$prefix" ]; then
    # Rename the folder only when complete.
    rm -rf prefix.part wheel
    mkdir -p prefix.part/include prefix.part/lib/cmake/OpenImageIO
    cp -r oiio/src/include/OpenImageIO robin/include/tsl prefix.part/include/
    mkdir -p prefix.part/include/OpenImageIO/detail/fmt
    for header in format ostream printf; do
        echo "#include <fmt/$header.h>" >"prefix.part/include/OpenImageIO/detail/fmt/$header.h"
    done
    sed -e "s/@PROJECT_VERSION_MAJOR@/3/; s/@PROJECT_VERSION_MINOR@/1/; s/@PROJECT_VERSION_PATCH@/16/" \
        -e "s/@PROJECT_VERSION_TWEAK@/0/; s/@PROJECT_VERSION_RELEASE_TYPE@//" \
        -e "s/@PROJ_NAMESPACE@/OpenImageIO/g; s/@PROJ_VERSION_NAMESPACE@/v3_1/g" \
        -e "s/@Imath_VERSION_MAJOR@/3/; s/@Imath_VERSION_MINOR@/1/; s/@CMAKE_CXX_STANDARD@/17/" \
        -e "s/^#cmakedefine01 \(.*\)/#define \1 0/" \
        oiio/src/include/OpenImageIO/oiioversion.h.in >prefix.part/include/OpenImageIO/oiioversion.h
    python3 -m pip download --quiet --no-deps --dest wheel "openimageio==$oiio"
    python3 -m zipfile -e wheel/*.whl wheel
    for name in OpenImageIO OpenImageIO_Util; do
        cp "wheel/OpenImageIO/lib/lib$name.so.3.1.16" prefix.part/lib/
        ln -s "lib$name.so.3.1.16" "prefix.part/lib/lib$name.so"
    done
    cat >prefix.part/lib/cmake/OpenImageIO/OpenImageIOConfig.cmake <<'END'
get_filename_component(prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
find_package(Imath REQUIRED)
foreach(name OpenImageIO_Util OpenImageIO)
    add_library(OpenImageIO::${name} SHARED IMPORTED)
    set_target_properties(OpenImageIO::${name} PROPERTIES
        IMPORTED_LOCATION "${prefix}/lib/lib${name}.so"
        INTERFACE_INCLUDE_DIRECTORIES "${prefix}/include"
        INTERFACE_LINK_LIBRARIES "Imath::Imath")
endforeach()
set_property(TARGET OpenImageIO::OpenImageIO APPEND PROPERTY
    INTERFACE_LINK_LIBRARIES OpenImageIO::OpenImageIO_Util)
set(OpenImageIO_VERSION 3.1.16.0)
set(OpenImageIO_INCLUDES "${prefix}/include")
set(OpenImageIO_LIBRARIES OpenImageIO::OpenImageIO OpenImageIO::OpenImageIO_Util)
set(OpenImageIO_LIB_DIR "${prefix}/lib")
END
    cat >prefix.part/lib/cmake/OpenImageIO/OpenImageIOConfigVersion.cmake <<'END'
set(PACKAGE_VERSION 3.1.16.0)
set(PACKAGE_VERSION_COMPATIBLE TRUE)
END
    mv prefix.part prefix
fi

cmake -S osl -B build -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$prefix" \
    -DCMAKE_INSTALL_PREFIX="$folder/installed" \
    -DLLVM_ROOT=/usr/lib/llvm-14 -DUSE_PYTHON=OFF -DUSE_QT=OFF -DUSE_PARTIO=OFF -DUSE_OPTIX=OFF \
    -DOSL_USE_OPTIX=OFF -DBUILD_TESTING=ON -DOSL_BUILD_TESTS=ON -DSTOP_ON_WARNING=OFF -DVEC_REPORT=OFF
cmake --build build --parallel "$jobs" --target oslc testrender testshade

# oslc looks for the standard header in the installation folder.
mkdir -p installed/share/OSL
cp -r osl/src/shaders installed/share/OSL/
cat <<END
export MXEON_OSLC=$folder/build/bin/oslc
export MXEON_TESTRENDER=$folder/build/bin/testrender
export MXEON_TESTSHADE=$folder/build/bin/testshade
END
