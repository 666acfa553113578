"""The reference parts of docs/, written from the declarations of scenes, laws, output and command line."""
