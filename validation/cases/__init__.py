"""What is compared, one module for each subject; `validation.catalogue` gathers them."""
