# make demo    set up, run the paper's column collapse with three materials on a coarse grid, compare them
# make figure2 set up, run the six columns of the paper's Figure 2, ours and as published, and compare them; minutes
# make unified set up, run the column with both unified laws beside their parents, compare them; two minutes
# make test    set up, run the tests
# make lint    set up, check style and types
# make bench   set up, time the library against a yardstick and the machine; about half an hour
# make docs    set up, write the generated parts of docs/ from the declarations

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
INSTALLED := $(VENV)/.installed

DEMO := runs/demo
MATERIALS := mu_i_lc mcc_ocr1 mcc_ocr4

FIGURE2 := runs/figure2
COLUMNS := $(MATERIALS) mu_i_lc_published mcc_ocr1_published mcc_ocr4_published

UNIFIED := runs/unified
STATE := mu_i_state_loose mu_i_state_dense
CLAY := mu_i_mcc_ocr1 mu_i_mcc_ocr4

.PHONY: demo figure2 unified test lint docs bench

$(INSTALLED): pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and \
		"grainlaw needs Python 3.11 or newer, for instance: make PYTHON=python3.12")'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet -c constraints.txt -e '.[dev]'
	@touch $@

demo: $(INSTALLED)
	@for material in $(MATERIALS); do \
		$(BIN)/grainlaw run scenes/collapse_$$material.toml --set grid.cell_size=0.0125 --threads 1 \
			--out $(DEMO)/$$material --overwrite || exit 1; \
	done
	@$(BIN)/grainlaw compare $(MATERIALS:%=$(DEMO)/%) --out $(DEMO)/comparison
	@$(BIN)/grainlaw movie $(MATERIALS:%=$(DEMO)/%) --side-by-side --out $(DEMO)/comparison/collapse.gif
	@echo "pictures:  $(DEMO)/comparison/*.png, $(DEMO)/*/*.png"
	@echo "film:      $(DEMO)/comparison/collapse.gif"
	@echo "ParaView:  $(MATERIALS:%=$(DEMO)/%/run.pvd)"
	@echo "summaries: $(MATERIALS:%=$(DEMO)/%/summary.json)"

figure2: $(INSTALLED)
	@for column in $(COLUMNS); do \
		$(BIN)/grainlaw run scenes/collapse_$$column.toml --out $(FIGURE2)/$$column --overwrite || exit 1; \
	done
	@$(BIN)/grainlaw compare $(COLUMNS:%=$(FIGURE2)/%) --out $(FIGURE2)/comparison
	@echo "pictures:  $(FIGURE2)/comparison/*.png"

unified: $(INSTALLED)
	@for column in $(MATERIALS) $(CLAY) $(STATE); do \
		$(BIN)/grainlaw run scenes/collapse_$$column.toml --set grid.cell_size=0.0125 --threads 1 \
			--out $(UNIFIED)/$$column --overwrite || exit 1; \
	done
	@$(BIN)/grainlaw compare $(STATE:%=$(UNIFIED)/%) --out $(UNIFIED)/state
	@$(BIN)/grainlaw compare $(MATERIALS:%=$(UNIFIED)/%) $(STATE:%=$(UNIFIED)/%) --out $(UNIFIED)/state_and_parents
	@$(BIN)/grainlaw compare $(MATERIALS:%=$(UNIFIED)/%) $(CLAY:%=$(UNIFIED)/%) --out $(UNIFIED)/clay_and_parents
	@echo "pictures:  $(UNIFIED)/*/*.png"

# A file stays with one worker, so that what its tests share is made once; tests/conftest.py says which come first.
test: $(INSTALLED)
	$(BIN)/python -m pytest -n 2 --dist loadfile --no-loadscope-reorder

lint: $(INSTALLED)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

bench: $(INSTALLED)
	$(BIN)/python -m benchmarks $(PARTS)

docs: $(INSTALLED)
	$(BIN)/python -m grainlaw.reference docs
