#!/usr/bin/env python3
"""Programs of somebody else's, built against what is installed, or with our sources within theirs.

usage: consumers.py BUILD SOURCE CHECK     (BUILD has the libraries built)

Each check has a folder of its own. What a program must not need is made unfindable while it is configured.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

HIDE = {"pkgconfig": "-DCMAKE_DISABLE_FIND_PACKAGE_PkgConfig=ON", "cgal": "-DCMAKE_DISABLE_FIND_PACKAGE_CGAL=ON",
        "boost": "-DCMAKE_DISABLE_FIND_PACKAGE_Boost=ON"}


class Refused(Exception):
    pass


class Skipped(Exception):
    pass


def run(*command, **options):
    command = [str(word) for word in command]
    ran = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options)
    if ran.returncode != 0:
        raise Refused(f"{' '.join(command)}\n{ran.stdout}")
    return ran.stdout


def installed(folder, *components):
    prefix = folder / "prefix"
    for component in components:
        run("cmake", "--install", BUILD, "--prefix", prefix, "--component", component)
    return prefix


def configured(folder, cmake, program, *options):
    """The build folder of a project with this CMakeLists.txt and a program `main.cpp`, configured."""
    (folder / "project").mkdir()
    (folder / "project/CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.25)\nproject(consumer CXX)\n" + cmake)
    shutil.copy(program, folder / "project/main.cpp")
    build = folder / "build"
    run("cmake", "-S", folder / "project", "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", *options)
    return build


def built(build):
    run("cmake", "--build", build)
    return run(build / "program")


def found(prefix, components, link, *more):
    return (f"find_package(wheeltap REQUIRED{' COMPONENTS ' + components if components else ''} PATHS {prefix} "
            f"NO_DEFAULT_PATH)\nadd_executable(program main.cpp)\ntarget_link_libraries(program PRIVATE {link})\n"
            + "\n".join(more))


def inference_alone(folder):
    """The engine needs neither NetCDF nor CGAL nor Boost."""
    prefix = installed(folder, "dev")
    build = configured(folder, found(prefix, "inference", "wheeltap::inference"),
                       SOURCE / "examples/polynomial_degree.cpp", *HIDE.values())
    said = built(build)
    assert "P(parabola | readings)" in said, said
    cache = (build / "CMakeCache.txt").read_text()
    for other in ("NETCDF", "CGAL", "CHOLMOD", "MATIO"):
        assert other not in cache.replace("CMAKE_DISABLE_FIND_PACKAGE_CGAL", ""), f"{other} was looked for"


def the_page(folder):
    """The first project and the program of docs/libraries.md, as they stand there; the program checks itself."""
    page = (SOURCE / "docs/libraries.md").read_text()
    program, move, prior, components = re.findall(r"^```cpp\n(.*?)^```", page, re.M | re.S)
    cmake = re.findall(r"^```cmake\n(.*?)^```", page, re.M | re.S)[0]
    (folder / "main.cpp").write_text(program)
    prefix = installed(folder, "dev")
    said = built(configured(folder, cmake, folder / "main.cpp", f"-DCMAKE_PREFIX_PATH={prefix}", *HIDE.values()))
    turns = re.search(r"(\d+) turns", said)
    assert turns and int(turns[1]) > 0, f"the move of its own was not used: {said}"
    print(said)
    # The page's other pieces about that program: its move and a prior of its own pass their self-tests.
    before, main = program.split("int main() {\n")
    problem = main[:main.index("  const Posterior")]
    (folder / "main.cpp").write_text(
        '#include <string>\n#include "inference/moves/self_tests.hpp"\n' + before + prior +
        "struct Mixture : Radar {};\nint models() {\n" + components + "return problem.space.size();\n}\n"
        "int main() {\n" + problem + move +
        "const PriorCheck own = check_prior(error.prior);\n"
        "for (const auto& fault : own.faults) std::puts(fault.c_str());\n"
        "return own.passed() && check.passed && models() == 4 ? 0 : 1;\n}\n")
    inside = folder / "pieces"
    inside.mkdir()
    said = built(configured(inside, cmake, folder / "main.cpp", f"-DCMAKE_PREFIX_PATH={prefix}", *HIDE.values()))
    assert "no fault found" in said, said


def native(folder):
    """Wider registers than the libraries were built for."""
    prefix = installed(folder, "dev")
    said = built(configured(folder, found(prefix, "fem", "wheeltap::fem",
                                          "target_compile_options(program PRIVATE -march=native)"),
                            SOURCE / "tests/base/wide_consumer.cpp"))
    assert said is not None


def everything(folder):
    """Without components: all that was built. After the prefix was moved, as a package of it would be."""
    moved = folder / "elsewhere"
    shutil.move(installed(folder, "dev"), moved)
    libraries = sorted(p.stem.removeprefix("libwheeltap_") for p in (moved / "lib").rglob("libwheeltap_*.a"))
    assert "identification" in libraries and "apps" not in libraries, libraries
    said = built(configured(folder, found(moved, "", " ".join(f"wheeltap::{name}" for name in libraries)),
                            SOURCE / "examples/damaged_beam.cpp"))
    assert "1 damage: P = " in said, said


def what_is_missing_is_named(folder):
    prefix = installed(folder, "dev")
    for number, (components, hidden, named) in enumerate([
            ("identification", "pkgconfig", "wheeltap::io needs PkgConfig::NETCDF, which is not found"),
            ("base colours", "cgal", 'no library "colours" was built; there are base, io')]):
        inside = folder / str(number)
        inside.mkdir()
        try:
            configured(inside, found(prefix, components, "wheeltap::base"), SOURCE / "examples/damaged_beam.cpp",
                       HIDE[hidden])
        except Refused as refused:
            said = " ".join(str(refused).split())
            assert named in said, said
        else:
            raise AssertionError(f"{components} was found")


def no_paths_of_this_machine(folder):
    """What is exported names no folder of this machine: neither ours nor a library's."""
    prefix = installed(folder, "dev")
    files = list(prefix.rglob("*.cmake"))
    assert len(files) > 10, files
    for file in files:
        for number, line in enumerate(file.read_text().splitlines(), 1):
            bad = re.search(r"(?<![\w}$])/(usr|home|work|root|tmp|opt|lib)/", line)
            # CMake's own line that knows /usr/lib for a prefix that is a link to it.
            if bad and "_realOrig" not in line and "_IMPORT_PREFIX" not in line:
                raise AssertionError(f"{file.name}:{number}: {line.strip()}")
            assert str(BUILD) not in line and str(SOURCE) not in line, f"{file.name}:{number}: {line.strip()}"


def within_another_project(folder):
    """add_subdirectory and FetchContent take the libraries that are asked for, and leave the project's own ways."""
    program = folder / "main.cpp"
    program.write_text('#include <cstdio>\n#include "base/random.hpp"\n#include "base/parallel.hpp"\n'
                       "int main() {\n  wheeltap::base::Random random(1, 0, 0, wheeltap::base::Purpose::simulation);\n"
                       '  std::printf("%.6f\\n", random.normal());\n}\n')
    ways = {
        "add_subdirectory": f"set(WHEELTAP_COMPONENTS inference)\nadd_subdirectory({SOURCE} wheeltap EXCLUDE_FROM_ALL)\n",
        "fetch_content": f"include(FetchContent)\nset(WHEELTAP_COMPONENTS inference)\n"
                         f"FetchContent_Declare(wheeltap SOURCE_DIR {SOURCE})\nFetchContent_MakeAvailable(wheeltap)\n"
                         "if(NOT TARGET wheeltap::inference OR TARGET wheeltap::io OR TARGET wheeltap)\n"
                         '  message(FATAL_ERROR "not what was asked for")\nendif()\n'
                         "set_property(TARGET wheeltap_inference PROPERTY EXCLUDE_FROM_ALL ON)\n"}
    for way, cmake in ways.items():
        inside = folder / way
        inside.mkdir()
        build = configured(inside, cmake + "add_executable(program main.cpp)\n"
                           "target_link_libraries(program PRIVATE wheeltap::base)\n", program, HIDE["pkgconfig"],
                           HIDE["cgal"])
        run("cmake", "--build", build, "--target", "program")
        assert float(run(build / "program")) != 0.0
        cache = (build / "CMakeCache.txt").read_text()
        assert "WHEELTAP_TESTS:BOOL=OFF" in cache and "gtest" not in cache.lower(), "the tests came along"
        assert "CMAKE_CXX_COMPILER_LAUNCHER" not in cache.replace("CMAKE_CXX_COMPILER_LAUNCHER:STRING=\n", "")
        # One real source of the library, to see that it compiles there.
        run("cmake", "--build", build, "--target",
            "wheeltap/inference/CMakeFiles/wheeltap_inference.dir/statistics/standard_normal.cpp.o"
            if way == "add_subdirectory" else
            "_deps/wheeltap-build/inference/CMakeFiles/wheeltap_inference.dir/statistics/standard_normal.cpp.o")


def uninstall_leaves_nothing(folder):
    """All three components, and what Python made of its own beside them."""
    components = ["program", "dev"] + (["python"] if (BUILD / "python/wheeltap").is_dir() else [])
    # A build folder of its own for the manifests, as if nothing else had been installed from it.
    before = {p: p.read_bytes() for p in BUILD.glob("install_manifest*.txt")}
    prefix = installed(folder, *components)
    assert run(prefix / "bin/wheeltap", "--version").startswith("wheeltap ")
    if "python" in components:
        [site] = prefix.rglob("site-packages")
        environment = {**os.environ, "PYTHONPATH": str(site), "PYTHONDONTWRITEBYTECODE": ""}
        said = run(PYTHON, "-c", "import wheeltap; print(wheeltap.__version__, wheeltap.__file__)", env=environment)
        assert str(site) in said, said
    (prefix / "bin/mine").write_text("somebody else's")
    run("cmake", f"-DBUILD={BUILD}", "-P", SOURCE / "cmake/uninstall.cmake")
    left = [str(p.relative_to(prefix)) for p in sorted(prefix.rglob("*"))]
    for path, content in before.items():
        path.write_bytes(content)
    assert left == ["bin", "bin/mine"], left


def debian_packages(folder):
    """One a component, with dependencies read off the programs; what they hold runs."""
    if not shutil.which("dpkg-shlibdeps") or not shutil.which("dpkg-deb"):
        raise Skipped("no dpkg-dev")
    run("cpack", "-G", "DEB", "--config", BUILD / "CPackConfig.cmake", "-B", folder / "made")
    made = {p.name.split("_")[0]: p for p in (folder / "made").glob("*.deb")}
    wanted = ["libwheeltap-dev", "wheeltap"] + (["python3-wheeltap"] if (BUILD / "python/wheeltap").is_dir() else [])
    if "WHEELTAP_WITH_MANUAL:BOOL=ON" in (BUILD / "CMakeCache.txt").read_text():
        wanted.append("wheeltap-doc")
    assert sorted(made) == sorted(wanted), made
    needs = run("dpkg-deb", "-f", made["wheeltap"], "Depends")
    assert "libnetcdf" in needs and "libc6" in needs, needs
    for name, package in made.items():
        run("dpkg-deb", "-x", package, folder / "root")
        for document in ("copyright", "changelog.gz"):
            assert (folder / "root/usr/share/doc" / name / document).exists(), f"{name} has no {document}"
        assert len(run("dpkg-deb", "-f", package, "Description").splitlines()) > 3, f"{name} says little of itself"
    assert run(folder / "root/usr/bin/wheeltap", "--version").startswith("wheeltap ")
    assert (folder / "root/usr/include/wheeltap/inference/engine/reversible_jump.hpp").exists()
    if "python3-wheeltap" in made:
        site = folder / "root/usr/lib/python3/dist-packages"
        run(PYTHON, "-c", "import wheeltap", env={**os.environ, "PYTHONPATH": str(site)})


CHECKS = [inference_alone, the_page, native, everything, what_is_missing_is_named, no_paths_of_this_machine,
          within_another_project, uninstall_leaves_nothing, debian_packages]

if __name__ == "__main__":
    BUILD, SOURCE = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
    PYTHON = sys.argv[4] if len(sys.argv) > 4 else sys.executable
    check = {c.__name__: c for c in CHECKS}[sys.argv[3]]
    with tempfile.TemporaryDirectory() as made:
        try:
            check(pathlib.Path(made))
        except Skipped as why:
            print(f"skipped: {why}")
            sys.exit(77)
        except (AssertionError, Refused) as error:
            sys.exit(f"{check.__name__}: {error}")
    print(f"{check.__name__}: as it should be")
