# Everything a newcomer needs: `make demo`, `make test`, `make bench`.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
RUST_SOURCES := Cargo.toml Cargo.lock $(shell find crates -name '*.rs' -o -name Cargo.toml)
export CARGO_TERM_COLOR ?= auto
export PIP_DISABLE_PIP_VERSION_CHECK = 1

.PHONY: demo figures site test test-rust test-python bench many peers linear long long-rust long-python fuzz format clean

demo: $(VENV)/.optimised
	$(BIN)/asperity demo --out out/demo

# FIGURES names some of them by number: `make figures FIGURES="1 17"`.
figures: $(VENV)/.installed
	cd examples && ../$(BIN)/python -m paper --out ../out/figures $(FIGURES)

# Two parts at a time: compiling, linking and tests of one process leave a core idle that the other part takes.
test:
	$(MAKE) --jobs=2 test-python test-rust

# In a fresh clone crates are built without the tables that make the next build quicker: they cost a seventh of the time.
test-rust: export CARGO_INCREMENTAL ?= $(if $(wildcard target/debug/incremental),1,0)
# Without default features little is run: what the optimiser would save is less than what it costs.
PLAIN = --no-default-features --features serde --config profile.dev.package.asperity.opt-level=0
test-rust:
	cargo fmt --all --check
	cargo clippy --workspace --all-targets --features asperity/serde --locked -- -D warnings
	cargo clippy -p asperity --no-default-features --locked -- -D warnings
	cargo test -p asperity-set -p asperity -p asperity-fuzz --features asperity/serde,asperity-set/serde --locked --quiet
	cargo test -p asperity $(PLAIN) --test features --test methods --locked --quiet
	cargo test -p asperity $(PLAIN) --lib --locked --quiet -- linear newton_matrix
	RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --features asperity/serde --locked --quiet
	cd benches/linear && cargo fmt --check

# Two processes whose products of matrices wait for each other's threads take a hundred times as long.
test-python long-python: export OPENBLAS_NUM_THREADS = 1
test-python: $(VENV)/.installed
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/python -m mypy.stubtest asperity._core --ignore-disjoint-bases
	$(BIN)/pytest --numprocesses auto --dist loadscope

# Pages, gallery and reference, without a network; what has not changed is not built again.
site: $(VENV)/.installed $(VENV)/.documented
	$(BIN)/python site/build.py --out out/site

# Runs all benches and writes docs/performance.md from their ratios.
bench: $(VENV)/.optimised
	$(BIN)/python benches/performance.py

# Time and memory of the default solver, from 10 to 10⁵ contacts.
many: $(VENV)/.optimised
	$(BIN)/python benches/many_contacts.py

# The same problems through other engines; PROBLEMS names a folder of problem files, absent engines are
# named with what to install.
peers: $(VENV)/.optimised
	$(BIN)/python benches/peers/compare.py $(PROBLEMS) --csv out/peers.csv

# The sparse factorisations beside faer's, on the problems of PROBLEMS, of ASPERITY_CONTACT_PROBLEMS, or on walls.
linear:
	cd benches/linear && cargo run --release --locked --target-dir ../../target -- $(abspath $(PROBLEMS))

# The long profile, an hour on two cores that do nothing else, the package built as wheels are: random cases per set and property,
# 10⁵ one-contact problems per law, the bytes of the fuzz targets' generator, and every Python test that is marked `long`.
# ONLY, SETS and INPUTS shorten a part: `make long SETS=1000 INPUTS=1000 ONLY=test_metamorphic`.
SETS ?= 10000
INPUTS ?= 10000
ONLY ?=
# Two parts at a time, as in `make test`, and what fails stops neither.
long:
	$(MAKE) --jobs=2 --keep-going long-python long-rust

# To build with optimisation across crates takes nine minutes.
long-rust: export CARGO_PROFILE_RELEASE_LTO = off
long-rust: export CARGO_PROFILE_RELEASE_CODEGEN_UNITS = 16
long-rust:
	failed=0; \
	PROPTEST_CASES=$(SETS) cargo test --release --locked --no-fail-fast -p asperity-set || failed=1; \
	cargo test --release --locked --no-fail-fast -p asperity -- --ignored || failed=1; \
	cargo test $(PLAIN) --locked --no-fail-fast -p asperity --lib || failed=1; \
	ASPERITY_FUZZ_INPUTS=$(INPUTS) cargo test -p asperity-fuzz --profile fuzz --locked --no-fail-fast || failed=1; \
	exit $$failed

# Every test is told when it ends, so that a run that is cut off has said something. The package is built as wheels
# are: that takes some minutes more and makes the solvers, which take most of the time, up to twice as fast.
long-python: $(VENV)/.optimised
	$(BIN)/pytest --numprocesses auto -vv --dist worksteal --durations 30 --timeout 7200 -m long -k "$(ONLY)"

# libFuzzer on stable Rust, SECONDS per target; needs a C++ compiler. What it finds is in out/fuzz: give it to
# the binary again, or into fuzz/corpus, from where `make test` replays it.
SECONDS ?= 3600
TARGETS ?= sets one_contact many_contacts events steps
TIMEOUT ?= 30
HOST = $(shell rustc -vV | sed -n 's/^host: //p')
FUZZ_FLAGS = --cfg fuzzing -Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
	-Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
	-Cllvm-args=-sanitizer-coverage-trace-compares -Ccodegen-units=1
fuzz:
	RUSTFLAGS="$(FUZZ_FLAGS)" cargo build -p asperity-fuzz --profile fuzz --locked --bins --features libfuzzer-sys \
		--target $(HOST)
	found=0; for target in $(TARGETS); do \
		mkdir -p out/fuzz/corpus/$$target; \
		target/$(HOST)/fuzz/$$target out/fuzz/corpus/$$target fuzz/corpus/$$target \
			-max_total_time=$(SECONDS) -timeout=$(TIMEOUT) -rss_limit_mb=4096 -max_len=1024 \
			-artifact_prefix=out/fuzz/$$target- -print_final_stats=1 || found=1; \
	done; exit $$found

format:
	cargo fmt --all
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

clean:
	rm -rf target $(VENV) out

# The Rust library is rebuilt whenever its sources change: an editable install alone would keep a
# stale one. Tests take any build; without optimisation across crates, which one core does alone, it is ready sooner.
$(VENV)/.installed: $(VENV)/.created $(RUST_SOURCES) pyproject.toml
	rm -f $(VENV)/.optimised
	CARGO_PROFILE_RELEASE_LTO=off CARGO_PROFILE_RELEASE_CODEGEN_UNITS=16 $(BIN)/pip install --quiet --editable '.[dev]'
	touch $@

# What is measured, and what users run first, is built as wheels are.
$(VENV)/.optimised: $(VENV)/.created $(RUST_SOURCES) pyproject.toml
	$(BIN)/pip install --quiet --editable '.[dev]'
	touch $(VENV)/.installed $@

# What the extra `docs` adds to `dev`, without building the package once more.
DOCS = import tomllib; extras = tomllib.load(open("pyproject.toml", "rb"))["project"]["optional-dependencies"]
$(VENV)/.documented: $(VENV)/.created pyproject.toml
	$(BIN)/python -c '$(DOCS); print(*(one for one in extras["docs"] if "asperity" not in one), sep="\n")' > $(VENV)/docs.txt
	$(BIN)/pip install --quiet --requirement $(VENV)/docs.txt
	touch $@

$(VENV)/.created:
	$(PYTHON) -c 'import sys; sys.exit("Python 3.11 or newer is needed" if sys.version_info < (3, 11) else 0)'
	$(PYTHON) -m venv $(VENV)
	touch $@
