"""What setuptools does not know of the package: its libraries, which are no extension modules.

They are those of the build that SKEIN_LIBRARY names (tools/wheel), or, from the source distribution, are built by CMake from
what lies in source/. jansson and liblbfgs go along, for they need them wherever they are installed.
"""
import glob
import os
import re
import shutil
import subprocess
import sysconfig

from setuptools import setup
from setuptools.command.build_py import build_py
from wheel.bdist_wheel import bdist_wheel

HERE = os.path.dirname(os.path.abspath(__file__))
OPTIONS = ["TESTS", "EXAMPLES", "INSTALL", "VIEWER", "FILM", "CHOLMOD", "GPU", "MPI"]


def build_libraries(folder):
    """Builds them from source/; says what is missing."""
    source = os.path.join(HERE, "source")
    for tool in "cmake", "cc", "pkg-config":
        if not shutil.which(tool):
            raise SystemExit(f"skein: building from source needs {tool}: apt install gcc cmake pkg-config libjansson-dev "
                             "libepoxy-dev libegl-dev libstb-dev zlib1g-dev liblbfgs-dev; or install the wheel, which needs none")
    # what is drawn with is left out where it is not there: world.render() says so then
    draws = not subprocess.run(["pkg-config", "--exists", "epoxy", "egl", "zlib"]).returncode
    options = [f"-DSKEIN_{name}=OFF" for name in OPTIONS] + [f"-DSKEIN_RENDER={'ON' if draws else 'OFF'}"]
    subprocess.run(["cmake", "-S", source, "-B", folder, "-DCMAKE_BUILD_TYPE=Release", *options], check=True)
    targets = ["skein_python", "skein_python_double"] + ["skein_python_draw"] * draws
    subprocess.run(["cmake", "--build", folder, "-j", str(os.cpu_count()), "--target", *targets], check=True)
    return os.path.join(folder, "python")


def bring_along(name, asked_by, to):
    """Copies a library that another asks for, by the name that it asks for, with its licence."""
    needs = subprocess.run(["ldd", asked_by], check=True, capture_output=True, text=True).stdout
    asked, path = re.search(rf"({name}\S*) => (\S+)", needs).groups()
    shutil.copy(path, os.path.join(to, asked))
    licences = glob.glob(f"/usr/share/doc/{name}[0-9]*/copyright")
    if licences:
        shutil.copy(licences[0], os.path.join(to, f"{name}.copyright"))


class BuildWithLibraries(build_py):
    def run(self):
        super().run()
        built = os.environ.get("SKEIN_LIBRARY") or build_libraries(os.path.join(HERE, "build", "skein"))
        to = os.path.join(self.build_lib, "skein")
        for name in "libskein.so", "libskein_draw.so", "skein_fit.so":
            if name == "libskein.so" or os.path.exists(os.path.join(built, name)):
                shutil.copy(os.path.join(built, name), to)
        double = os.path.join(built, "double", "libskein.so")
        if os.path.exists(double):
            os.makedirs(os.path.join(to, "double"), exist_ok=True)
            shutil.copy(double, os.path.join(to, "double"))
        bring_along("libjansson", os.path.join(built, "libskein.so"), to)
        if os.path.exists(os.path.join(built, "skein_fit.so")):
            bring_along("liblbfgs", os.path.join(built, "skein_fit.so"), to)


class Wheel(bdist_wheel):
    """For any Python 3, on this machine's kind of system."""

    def finalize_options(self):
        super().finalize_options()
        self.root_is_pure = False

    def get_tag(self):
        return "py3", "none", sysconfig.get_platform().replace("-", "_").replace(".", "_")


setup(cmdclass={"build_py": BuildWithLibraries, "bdist_wheel": Wheel})
