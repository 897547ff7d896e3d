//! Apache Parquet, by its own crate without Arrow.

use std::sync::Arc;

use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::record::Field;
use parquet::schema::types::{Type, TypePtr};

use crate::table::{Column, Table};

/// All columns, their cells as text; what is null is empty.
pub(crate) fn read(bytes: Vec<u8>) -> Result<Table, String> {
    table(bytes).map_err(|error| error.to_string())
}

fn table(bytes: Vec<u8>) -> Result<Table, ParquetError> {
    let reader = SerializedFileReader::new(bytes::Bytes::from(bytes))?;
    let schema = reader.metadata().file_metadata().schema_descr();
    let names = schema.root_schema().get_fields().iter().map(|field| field.name().to_owned()).collect();
    let mut rows = vec![];
    for row in reader.get_row_iter(None)? {
        rows.push(row?.get_column_iter().map(|(_, field)| cell(field)).collect());
    }
    Ok(Table { names, rows })
}

fn cell(field: &Field) -> String {
    match field {
        Field::Null => String::new(),
        Field::Str(text) => text.clone(),
        // Numbers in the shortest form that reads back to the same bits.
        Field::Double(value) => value.to_string(),
        Field::Float(value) => value.to_string(),
        other => other.to_string(),
    }
}

/// Columns as one row group.
pub(crate) fn write(columns: &[(String, Column)]) -> Result<Vec<u8>, String> {
    file(columns).map_err(|error| error.to_string())
}

fn file(columns: &[(String, Column)]) -> Result<Vec<u8>, ParquetError> {
    let fields = columns.iter().map(|(name, column)| field(name, column)).collect::<Result<Vec<TypePtr>, _>>()?;
    let schema = Type::group_type_builder("ntg").with_fields(fields).build()?;
    let mut bytes = vec![];
    let mut writer =
        SerializedFileWriter::new(&mut bytes, Arc::new(schema), Arc::new(WriterProperties::builder().build()))?;
    let mut group = writer.next_row_group()?;
    for (_, column) in columns {
        let Some(mut out) = group.next_column()? else { break };
        match column {
            Column::Count(values) => {
                out.typed::<Int64Type>().write_batch(values, None, None)?;
            }
            Column::Number(values) => {
                let levels: Vec<i16> = values.iter().map(|value| i16::from(value.is_some())).collect();
                let there: Vec<f64> = values.iter().flatten().copied().collect();
                out.typed::<DoubleType>().write_batch(&there, Some(&levels), None)?;
            }
            Column::Words(values) => {
                let words: Vec<ByteArray> = values.iter().map(|words| ByteArray::from(words.as_str())).collect();
                out.typed::<ByteArrayType>().write_batch(&words, None, None)?;
            }
        }
        out.close()?;
    }
    group.close()?;
    writer.close()?;
    Ok(bytes)
}

fn field(name: &str, column: &Column) -> Result<TypePtr, ParquetError> {
    let (physical, repetition, logical) = match column {
        Column::Count(_) => (Physical::INT64, Repetition::REQUIRED, None),
        Column::Number(_) => (Physical::DOUBLE, Repetition::OPTIONAL, None),
        Column::Words(_) => (Physical::BYTE_ARRAY, Repetition::REQUIRED, Some(LogicalType::String)),
    };
    let builder = Type::primitive_type_builder(name, physical).with_repetition(repetition);
    Ok(Arc::new(builder.with_logical_type(logical).build()?))
}
