# The short way in: each line below runs one script of tools/, and the scripts run CMake.
# CMake alone does as well: cmake --preset release && cmake --build --preset release

.PHONY: all install demo test test-elsewhere verify-blender npm wheel playground test-web fuzz setup gallery site emit names debug format clean help

all: ## (or plain make) build the command: build/skein
	@tools/build release skein_whole

install: ## build and install it all: PREFIX=/usr/local, DESTDIR=
	@PREFIX='$(PREFIX)' tools/install

demo: ## set up, build, and drape cloth over a real mesh: files, a picture and a film in out/demo, and a window
	@tools/setup build
	@tools/build release skein
	@tools/demo

test: ## set up, build and pass every test, in every build; says how many minutes each took
	@tools/setup test
	@tools/test

verify-blender: ## set up, build, and check in Blender, without its window, that caches, GLB and the add-on lie right
	@tools/setup blender
	@tools/build release skein
	@tools/blender/verify build/skein

npm: ## set up, build and test the package for JavaScript: build/skein-VERSION.tgz
	@tools/setup web
	@tools/npm --test

wheel: ## set up, build and test the package for Python: build/skein-VERSION-py3-none-PLATFORM.whl, and its source
	@tools/setup python
	@tools/wheel --test

playground: ## set up, and build the page for browsers: build/playground, for any server of files
	@tools/setup web
	@tools/playground

test-web: ## the same, and try the page in Chromium without a screen (not part of `make test`)
	@tools/setup web
	@tools/test-web

test-elsewhere: ## build and test the library for 64-bit ARM (qemu) and Windows (mingw-w64, Wine); not part of `make test`
	@tools/setup elsewhere
	@tools/test-elsewhere

fuzz: ## look for crashes with random input: 60 seconds a reader (tools/fuzz --seconds N takes longer)
	@tools/setup test
	@tools/fuzz

setup: ## install the Debian packages that building and testing need
	@tools/setup test

gallery: ## build, and draw the documents' pictures and film anew
	@tools/setup build
	@tools/build release skein
	@tools/gallery

emit: ## build, and write the constraints' kernels anew from their formulas (src/constraints/emitted)
	@tools/build release skein
	@tools/emit

site: ## make the manual a site with a search: build/site (needs no build of Skein)
	@tools/setup site
	@tools/site

names: ## build, and write the header of names anew from the tables of fields (include/skein/names.h)
	@tools/build release skein_names
	@build/skein_names >build/names.h
	@cp build/names.h include/skein/names.h

debug: ## build with assertions: build-debug/skein
	@tools/build debug skein

format: ## put the C files into the house's style (needs clang-format)
	@tools/format

clean: ## remove everything that was built
	rm -rf build build-debug build-asan build-tsan build-clang build-double build-fuzz build-wasm \
	    build-aarch64 build-mingw

help: ## this list
	@sed -n 's/^\([a-z-]*\):.*## /\1\t/p' Makefile | while IFS="$$(printf '\t')" read -r name words; do \
	    printf '  make %-14s %s\n' "$$name" "$$words"; done
